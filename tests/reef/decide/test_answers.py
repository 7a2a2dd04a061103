import pytest

from coral.advisor.parse import parse_answer
from coral.advisor.prompt import render
from coral.advisor.question import BadAnswer
from coral.reef.decide.answers import CentroidAnswer, CentroidChoice, MissionAnswer, WaypointAnswer, WaypointChoice


@pytest.mark.parametrize(
    ("text", "forward", "left"),
    [
        ('{"Move forward 4 meters, move right 1 meter": "1. ..."}', 4, -1),
        ("{'Move backward 2 meters, move left 3 meters': 'because'}", -2, 3),
        ('{"move forward by 5 m": "straight on"}', 5, 0),
        ('{"Forward 0 m, left 6 m": null}', 0, 6),
        ('{"forward_m": 4, "left_m": -1, "reason": "so"}', 4, -1),
        ('{"forward_m": 4.0, "left_m": "-1"}', 4, -1),
    ],
)
def test_waypoint_forms(text, forward, left):
    choice = parse_answer(text, WaypointChoice)
    assert (choice.forward_m, choice.left_m) == (forward, left)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ('{"Move forward 9 meters, move right 1 meter": "far"}', "out-of-range"),
        ('{"forward_m": 7, "left_m": 0}', "out-of-range"),
        ('{"forward_m": 1.5, "left_m": 0}', "wrong-type"),
        ('{"forward_m": true, "left_m": 0}', "wrong-type"),
        ('{"stay here": "tired"}', "missing-field"),
    ],
)
def test_bad_waypoints(text, code):
    with pytest.raises(BadAnswer) as bad:
        parse_answer(text, WaypointChoice)
    assert bad.value.rejection.code == code


def test_long_reason_is_cut_not_refused():
    choice = parse_answer('{"selected_centroid_index": 1, "reason": "' + "x" * 9000 + '"}', CentroidChoice)
    assert len(choice.reason) == 4000


def test_no_dot():
    assert (
        parse_answer('{"selected_centroid_index": null, "reason": "none"}', CentroidChoice).selected_centroid_index
        is None
    )


@pytest.mark.parametrize(
    ("kind", "answer_type"),
    [
        ("reef-centroid", CentroidChoice),
        ("reef-waypoint", WaypointChoice),
        ("reef-centroid-paper", CentroidAnswer),
        ("reef-waypoint-paper", WaypointAnswer),
    ],
)
def test_example_in_the_prompt_is_a_valid_answer(kind, answer_type):
    text, _ = render(kind, step_m=6, facts={"arrival": {"in_s": 5.0}}, latency_s=10.0, inspect_m=2.3)
    example = text.split("Example:")[1].split("```")[1].removeprefix("json")
    assert "1." in parse_answer(example, answer_type).reason


def test_what_goes_beyond_the_paper_may_be_left_out_of_an_answer():
    choice = parse_answer('{"selected_centroid_index": 3}', CentroidChoice)
    assert (choice.then, choice.waypoint, choice.expect, choice.end_survey) == ((), None, None, False)
    given = parse_answer('{"forward_m": 0, "left_m": 2, "expect": {"what": "more", "sure": 0.7}}', WaypointChoice)
    assert (given.expect.sure, given.expect.forward_m) == (0.7, None)
    with pytest.raises(BadAnswer):
        parse_answer('{"forward_m": 0, "left_m": 2, "expect": {"what": "more", "sure": 70}}', WaypointChoice)


def test_schema_states_the_bounds():
    for axis in ("forward_m", "left_m"):
        schema = WaypointChoice.model_json_schema()["properties"][axis]
        assert (schema["minimum"], schema["maximum"]) == (-6, 6)


def test_lists_are_cut_and_null_means_nothing():
    answer = MissionAnswer.model_validate(
        {
            "selected_centroid_index": 3,
            "then": [1, 2, 4, 5],
            "skip": None,
            "marks": [{"dot": 1, "label": None}],
            "answer": None,
        }
    )
    assert answer.then == (1, 2, 4)
    assert answer.skip == ()
    assert answer.marks[0].label == ""
    assert not answer.end_survey


def test_done_ends_the_survey():
    assert MissionAnswer(done=True, answer="4").end_survey
