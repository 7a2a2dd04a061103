import numpy as np
import pytest
from pydantic import BaseModel, Field

from coral.advisor.corrupt import corrupt
from coral.advisor.question import Question


class Choice(BaseModel):
    selected_index: int | None
    reason: str = "because"


class Waypoint(BaseModel):
    forward_m: int = Field(ge=-6, le=6)
    left_m: int = Field(ge=-6, le=6)


class Words(BaseModel):
    what: str
    why: str


FACTS = {
    "robot": {"x": 1.0, "y": 1.0, "theta": 0.0},
    "centroids": [
        {"index": 0, "x": 0.0, "y": 1.0},
        {"index": 1, "forward_m": 2.0},
        {"index": 2, "x": 3.0, "y": 1.0},
        {"index": 3, "forward_m": -1.0},
    ],
}


def spoilt(error, answer, facts=FACTS, n=60):
    """Many ways in which an answer goes wrong."""
    question = Question(kind="any", prompt="", answer_type=type(answer), facts=facts)
    rng = np.random.default_rng(0)
    return [corrupt(error, question, answer.model_dump(), rng) for _ in range(n)]


@pytest.mark.parametrize("facts", [FACTS, {"n_things": 4}])
def test_an_index_out_of_range_is_beyond_what_can_be_chosen(facts):
    found = spoilt("out_of_range", Choice(selected_index=1), facts)
    assert {answer["selected_index"] for answer in found} == {4, 5, 6, 7, 8}
    assert {answer["reason"] for answer in found} == {"because"}


def test_a_number_out_of_range_breaks_the_bound_of_its_schema():
    right = Waypoint(forward_m=3, left_m=1)
    for answer in spoilt("out_of_range", right):
        changed = {key: value for key, value in answer.items() if value != getattr(right, key)}
        assert len(changed) == 1
        assert all(6 < value <= 11 for value in changed.values())


def test_backward_is_behind_the_robot():
    found = spoilt("backward", Choice(selected_index=1))
    assert {answer["selected_index"] for answer in found} == {0, 3}
    found = spoilt("backward", Waypoint(forward_m=3, left_m=1), n=90)
    assert {answer["forward_m"] for answer in found} == {-1, -2, -3, -4, -5, -6}
    assert {answer["left_m"] for answer in found} == {1}


def test_with_nothing_behind_backward_is_where_it_has_been():
    ahead = [{"index": k, "x": 5.0, "y": float(k), "visited": k == 2} for k in range(4)]
    found = spoilt("backward", Choice(selected_index=1), {**FACTS, "centroids": ahead})
    assert {answer["selected_index"] for answer in found} == {2}


def test_a_wrong_type_is_no_number():
    for answer in spoilt("wrong_type", Choice(selected_index=1)):
        assert not isinstance(answer["selected_index"], int)


@pytest.mark.parametrize("error", ["wrong_type", "out_of_range", "backward"])
def test_an_answer_without_numbers_loses_a_field(error):
    assert spoilt(error, Words(what="a", why="b"), n=1) == [{"why": "b"}]


def test_the_right_answer_stays_as_it_was():
    right, rng = {"selected_index": 1, "reason": "because"}, np.random.default_rng(0)
    question = Question(kind="any", prompt="", answer_type=Choice, facts=FACTS)
    assert corrupt("backward", question, right, rng) != right
    assert right == {"selected_index": 1, "reason": "because"}
