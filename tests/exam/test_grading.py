import pytest

from coral.contact.plan.cost_plan import PlanAnswer
from coral.exam.asking import Sheet
from coral.exam.grading import Grader, outcome
from coral.exam.item import ExamItem
from coral.reef.decide.answers import CentroidChoice

FLAT = PlanAnswer(code="def state_cost(self):\n    return 1.0\n")
"""Refused before anything is simulated."""


def dot(index, id="dot"):
    item = ExamItem(
        id=id,
        kind="reef-centroid",
        group="w",
        prompt="",
        prompt_version="1",
        facts={},
        key={"seconds": {"1": 40.0, "2": 45.0}},
    )
    return Sheet(item=item, answer=CentroidChoice(selected_centroid_index=index))


@pytest.fixture(scope="module")
def plan_items(few):
    return [item for item in few.items if item.kind == "cost-function"]


def test_sheets_are_graded_in_their_order():
    graded = Grader().grade([dot(1), dot(2), dot(7)])
    assert [one.worth.score for one in graded] == pytest.approx([1.0, 0.5, 0.0])
    assert [one.sheet.answer.selected_centroid_index for one in graded] == [1, 2, 7]


def test_a_sheet_without_an_answer_is_worth_nothing_and_says_why():
    (graded,) = Grader().grade([Sheet(item=dot(1).item, answer=None, failure="deadline: no answer within 60 s")])
    assert (graded.worth.score, graded.worth.why) == (0.0, "deadline: no answer within 60 s")


def test_the_same_plan_for_the_same_question_is_followed_once_whoever_gave_it(plan_items, monkeypatch):
    followed = []
    monkeypatch.setattr("coral.exam.grading.outcome", lambda *work: followed.append(1) or outcome(*work))
    grader = Grader()
    first, second = plan_items
    again = PlanAnswer.model_validate(FLAT.model_dump())
    graded = grader.grade([Sheet(item=first, answer=FLAT), Sheet(item=first, answer=again)])
    assert [one.worth.why for one in graded] == ["refused: constant"] * 2
    assert len(followed) == 1
    grader.grade([Sheet(item=first, answer=FLAT), dot(1)])
    assert len(followed) == 1
    grader.grade([Sheet(item=second, answer=FLAT)])
    assert len(followed) == 2


def test_an_answer_as_text_is_worth_what_the_answer_is():
    sheet = dot(2)
    worth = outcome(sheet.item.kind, dict(sheet.item.key), {}, sheet.answer.model_dump_json())
    assert worth == Grader().grade([sheet])[0].worth
