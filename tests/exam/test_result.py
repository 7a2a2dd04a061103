import pytest

from coral.advisor.question import Usage
from coral.exam.asking import Sheet
from coral.exam.grading import Graded
from coral.exam.item import ExamItem
from coral.exam.result import Result
from coral.exam.worth import Worth


def graded(kind, score, group="a", usage=None):
    item = ExamItem(id=f"{kind}-{score}", kind=kind, group=group, prompt="", prompt_version="1", facts={})
    sheet = Sheet(item=item, answer=None, usage=usage or Usage(requests=0), seconds=2.0)
    return Graded(sheet, Worth(score, ""))


def test_score_is_the_mean_of_kinds():
    marks = [graded("x", 1.0), graded("x", 1.0), graded("x", 1.0), graded("y", 0.0)]
    row = Result(name="one", graded=tuple(marks)).row()
    assert row["score"] == pytest.approx(0.5)
    assert row["by_kind"]["x"]["questions"] == 3
    assert row["low"] == row["high"] == pytest.approx(0.5)  # no spread within kinds


def test_interval_holds_the_score_and_narrows_with_questions():
    few = Result(name="few", graded=tuple(graded("x", k % 2, f"w{k}") for k in range(10))).row()
    many = Result(name="many", graded=tuple(graded("x", k % 2, f"w{k}") for k in range(200))).row()
    assert few["low"] < few["score"] < few["high"]
    assert many["high"] - many["low"] < 0.5 * (few["high"] - few["low"])


def test_groups_are_drawn_whole():
    alike = Result(name="a", graded=tuple(graded("x", float(k >= 50), f"w{k // 50}") for k in range(100))).row()
    assert (alike["low"], alike["high"]) == (0.0, 1.0)


def test_tokens_and_cost_are_null_where_a_reply_did_not_tell():
    told = graded("x", 1.0, usage=Usage(input_tokens=10, output_tokens=5, cost_usd=0.25))
    silent = graded("x", 1.0, usage=Usage())
    assert Result(name="a", graded=(told,)).row()["cost_usd"] == 0.25
    row = Result(name="a", graded=(told, silent)).row()
    assert row["tokens_in"] is None
    assert row["cost_usd"] is None
