import base64
import json
import re

import cv2
import numpy as np
import pytest

from coral.advisor.question import Picture, Usage
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer
from coral.exam.asking import Sheet
from coral.exam.grading import Graded
from coral.exam.item import ANSWERS, ExamItem
from coral.exam.report import WIDE_PX, write_report
from coral.exam.result import Result
from coral.exam.score import WORTH
from coral.exam.worth import Worth
from coral.reef.decide.answers import CentroidChoice


def png(width=840, height=600):
    return bytes(cv2.imencode(".png", np.full((height, width, 3), 128, np.uint8))[1])


def graded(score, answer=None, kind="reef-centroid", group="l1", pictures=(), why="loses 5.0 s", faults=()):
    item = ExamItem(id=f"{kind}-7", kind=kind, group=group, prompt="", prompt_version="1", facts={}, pictures=pictures)
    answer = answer or CentroidChoice(selected_centroid_index=2, reason="near")
    return Graded(Sheet(item=item, answer=answer, usage=Usage(requests=0, faults=faults)), Worth(score, why))


def page(folder, *results):
    made = [Result(name=name, graded=tuple(all_of)) for name, all_of in results]
    path = write_report(folder / "report.html", made, [one.row() for one in made], "public")
    assert path.parent == folder
    return path.read_text(encoding="utf-8")


def headline(text):
    return re.search(r'class="headline">(.*?)</p>', text)[1]


def test_every_kind_of_question_is_explained(tmp_path):
    assert set(WORTH) == set(ANSWERS)
    assert WORTH["reef-centroid"] in page(tmp_path, ("a", [graded(0.5)]))


def test_the_best_advisor_is_in_the_headline_with_its_interval(tmp_path):
    text = page(tmp_path, ("worse", [graded(0.25)]), ("better", [graded(0.75)]))
    assert headline(text) == "better scores 0.75 (0.75 to 0.75) of 1, clearly above worse with 0.25."
    assert text.index("<td>better</td>") < text.index("<td>worse</td>")


def test_advisors_whose_intervals_overlap_are_not_told_apart(tmp_path):
    spread = [graded(score, group=f"w{score}") for score in (0.0, 1.0)]
    text = page(tmp_path, ("a", spread), ("b", [graded(0.25)]))
    assert headline(text).endswith("of 1, not clearly above b with 0.25.")


def test_one_advisor_alone_is_compared_with_nobody(tmp_path):
    assert headline(page(tmp_path, ("a", [graded(0.5)]))) == "a scores 0.50 (0.50 to 0.50) of 1."


def test_the_worst_answers_are_shown_with_their_reason_and_their_code(tmp_path):
    plan = PlanAnswer(
        stages=[StageAnswer(name=name, code=f"def state_cost(self):\n    return {name}") for name in ("x", "y")]
    )
    text = page(tmp_path, ("a", [graded(0.0, plan, "cost-function", why="no success: timeout", faults=("http-429",))]))
    assert "l1: no success: timeout (http-429)" in text
    assert "return x\n\ndef state_cost(self):\n    return y" in text
    right = page(tmp_path, ("a", [graded(1.0)]))
    assert "Worst answers" not in right


def test_what_an_advisor_wrote_does_not_become_part_of_the_page(tmp_path):
    answer = CentroidChoice(selected_centroid_index=2, reason="<script>alert(1)</script>")
    text = page(tmp_path, ("<b>a</b>", [graded(0.5, answer)]))
    assert "<script>" not in text
    assert "<b>a</b>" not in text
    assert "&lt;script&gt;alert(1)" in text


@pytest.mark.parametrize(("width", "shown"), [(840, WIDE_PX), (100, 100)])
def test_pictures_are_shown_no_wider_than_their_place_and_at_most_two(tmp_path, width, shown):
    pictures = tuple(Picture(name=f"p{k}", png=png(width, 60), caption=f"Picture {k}.") for k in range(3))
    text = page(tmp_path, ("a", [graded(0.5, pictures=pictures)]))
    found = re.findall(r"data:image/webp;base64,([^\"]+)", text)
    assert len(found) == 2
    pixels = cv2.imdecode(np.frombuffer(base64.b64decode(found[0]), np.uint8), cv2.IMREAD_COLOR)
    assert pixels.shape[1] == shown
    assert "Picture 1." in text
    assert "Picture 2." not in text


def test_the_answer_without_its_code_is_shown_as_json(tmp_path):
    text = page(tmp_path, ("a", [graded(0.5)]))
    shown = re.search(r"<pre[^>]*>(\{.*?\})</pre>", text)[1].replace("&#34;", '"')
    assert json.loads(shown)["selected_centroid_index"] == 2


@pytest.mark.browser
def test_the_page_is_for_all_eyes(tmp_path, browser, check_for_all_eyes):
    page(
        tmp_path,
        ("worse", [graded(0.25)]),
        ("better", [graded(0.75, pictures=(Picture(name="map", png=png(), caption="Map."),))]),
    )
    shown = browser.new_page()
    shown.goto((tmp_path / "report.html").as_uri())
    check_for_all_eyes(shown)
    shown.close()
