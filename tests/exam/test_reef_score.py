import pytest

from coral.exam.reef_score import score_centroid, score_waypoint
from coral.reef.decide.answers import CentroidChoice, WaypointChoice

DOTS = {"seconds": {"1": 40.0, "2": 45.0, "3": 60.0, "4": "visited"}}
STEPS = {"seconds": {"4,-1": 30.0, "2,2": 32.0, "0,0": "too-near"}}


def dot(index):
    return score_centroid(DOTS, {}, CentroidChoice(selected_centroid_index=index))


def step(forward, left):
    return score_waypoint(STEPS, {}, WaypointChoice(forward_m=forward, left_m=left))


def test_a_dot_is_worth_what_it_does_not_lose_of_a_questions_time():
    assert [dot(index).score for index in (1, 2, 3)] == pytest.approx([1.0, 0.5, 0.0])
    assert dot(2).why == "loses 5.0 s"


def test_a_waypoint_is_found_by_its_metres():
    assert step(4, -1).score == 1.0
    assert step(2, 2).score == pytest.approx(0.8)


def test_what_the_verifiers_refuse_is_worth_nothing_and_says_why():
    assert (dot(4).score, dot(4).why) == (0.0, "refused: visited")
    assert (step(0, 0).score, step(0, 0).why) == (0.0, "refused: too-near")


def test_what_is_not_among_the_choices_is_worth_nothing():
    for worth in (dot(9), dot(None), step(6, 6)):
        assert (worth.score, worth.why) == (0.0, "refused: no such dot, or out of reach")
