import json

import pytest
from recorded import RULES

from coral.advisor.question import AdvisorUnavailable
from coral.advisor.rules import RuleAdvisor
from coral.desk.inbox import Inbox
from coral.errors import InputError
from coral.exam.asking import ask_all
from coral.exam.grading import EPISODES, Grader
from coral.exam.item import ANSWERS
from coral.exam.paper_inbox import answers, export
from coral.exam.question_set import load_set
from coral.exam.result import Result
from coral.reef.decide.heuristic import REEF_RULES

ALL_RULES = {**REEF_RULES, **RULES}


def answer_all(inbox):
    """The ten-line program."""
    for question in sorted(inbox.glob("*/question.json")):
        asked = json.loads(question.read_text())
        if asked["kind"] not in ALL_RULES:
            continue
        try:
            choice = ALL_RULES[asked["kind"]](asked["facts"], ())
        except AdvisorUnavailable:
            continue
        (question.parent / "answer.json").write_text(choice.model_dump_json())


def test_answers_from_an_inbox_score_as_those_given_directly(tmp_path):
    kinds = [kind for kind in ANSWERS if kind not in (*EPISODES, "reef-mission")]  # the public set has none in words
    items = load_set("public", kinds, 6).items
    assert export(items, tmp_path / "inbox", "public") == 6 * len(kinds)
    answer_all(tmp_path / "inbox")
    offline = Result(name="a", graded=tuple(Grader().grade(answers(items, tmp_path / "inbox")))).row()
    direct = Result(name="a", graded=tuple(Grader().grade(ask_all(RuleAdvisor(ALL_RULES), items)))).row()
    assert offline["by_kind"] == direct["by_kind"]
    assert 0.0 < offline["score"] == direct["score"]


def test_the_desk_shows_what_was_laid_out_and_no_key(tmp_path):
    items = load_set("public", limit=1).items
    export(items, tmp_path, "public")
    assert {entry.state for entry in Inbox(tmp_path).entries()} == {"open"}
    for folder, item in zip(sorted(tmp_path.glob("*-*")), items, strict=True):
        question = json.loads((folder / "question.json").read_text())
        assert (question["kind"], question["prompt"]) == (item.kind, item.prompt)
        assert question["answer_schema"] == item.question().answer_type.model_json_schema()
        assert not set(item.key) & set(question) - {"id"}


def test_missing_and_malformed_answers_are_worth_nothing(tmp_path):
    items = load_set("public", ["reef-centroid"], 2).items
    export(items, tmp_path, "public")
    (sorted(tmp_path.glob("*-*"))[0] / "answer.json").write_text("I am sorry")
    sheets = answers(items, tmp_path)
    assert [sheet.failure.partition(":")[0] for sheet in sheets][1] == "missing"
    assert [one.worth.score for one in Grader().grade(sheets)] == [0.0, 0.0]


def test_refuses_a_folder_that_holds_something(tmp_path):
    items = load_set("public", ["reef-centroid"], 1).items
    export(items, tmp_path, "public")
    with pytest.raises(InputError, match="not empty"):
        export(items, tmp_path, "public")
    with pytest.raises(InputError, match="no exported set"):
        answers(items, tmp_path / "elsewhere")
