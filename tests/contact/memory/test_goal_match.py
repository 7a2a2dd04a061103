"""Goals of two tasks, matched by kind, direction and manner."""

import json
import math

import pytest

from coral.contact.memory.goal_match import (
    fits_hand,
    joints_of,
    match_goals,
    roles,
    scene_distance,
    scene_numbers,
    translate_numbers,
)

LIFTED = {"kind": "lifted", "object": "box", "height_m": 0.1, "most_m": None}
GRASPED = {"kind": "grasped", "object": "box", "point": None, "within_m": 0.05}
TIPPED = {"kind": "pointing", "object": "box", "axis": "z", "direction": [1, 0, 0], "either_way": False}
ASIDE = {"kind": "pointing", "object": "box", "axis": "x", "direction": [0, 0, 1], "either_way": True}
OPENED = {"kind": "opened", "object": "drawer", "between_deg": None, "between_m": [0.08, 0.14]}
MAT = {"kind": "resting", "object": "can", "thing": "mat"}
UNTOUCHED = {"kind": "never-touched", "object": "box", "thing": "wall"}


def test_names_order_and_magnitudes_do_not_matter():
    found = match_goals([LIFTED, GRASPED], [{**GRASPED, "object": "can"}, {**LIFTED, "object": "can", "height_m": 0.3}])
    assert found.names == {"box": "can"}


@pytest.mark.parametrize(
    "asked",
    [
        [LIFTED],
        [LIFTED, GRASPED, {"kind": "flipped", "object": "box", "axis": "z", "degrees": 180.0}],
        [LIFTED, {**GRASPED, "point": "handle"}],
        [LIFTED, {**GRASPED, "object": "mug"}],
    ],
)
def test_other_kinds_points_and_objects_do_not_match(asked):
    assert match_goals([LIFTED, GRASPED], asked) is None


def test_a_direction_counts():
    assert match_goals([TIPPED], [{**TIPPED, "direction": [0.95, 0.3, 0]}]) is not None
    assert match_goals([TIPPED], [{**TIPPED, "direction": [-1, 0, 0]}]) is None
    assert match_goals([TIPPED], [{**TIPPED, "either_way": True}]) is None


def test_goals_of_one_kind_are_paired_in_any_order():
    assert match_goals([TIPPED, ASIDE], [ASIDE, TIPPED]) is not None
    assert match_goals([TIPPED, ASIDE], [ASIDE, ASIDE]) is None


def test_angles_may_differ_a_little():
    flipped = {"kind": "flipped", "object": "box", "axis": "z", "degrees": 90.0, "tolerance_deg": 15.0}
    assert match_goals([flipped], [{**flipped, "degrees": 80.0, "tolerance_deg": 5.0}]) is not None
    assert match_goals([flipped], [{**flipped, "degrees": 180.0}]) is None


def test_opening_is_not_closing():
    shut = {**OPENED, "between_m": [0.0, 0.01]}
    assert match_goals([OPENED], [{**OPENED, "between_m": [0.05, 0.1]}], {"drawer": 0.0}, {"drawer": 0.0}) is not None
    assert match_goals([OPENED], [shut], {"drawer": 0.0}, {"drawer": 0.11}) is None


def test_fixtures_and_places_correspond_by_their_part_in_the_goals():
    at = {"kind": "at", "object": "can", "place": "goal"}
    found = match_goals([MAT, at], [{**MAT, "thing": "tray"}, {**at, "place": "there"}])
    assert found.names == {"can": "can", "mat": "tray", "goal": "there"}
    assert match_goals([MAT, at], [{**MAT, "thing": "table"}, at]) is None


def test_one_thing_does_not_stand_for_two():
    other = {"kind": "at-object", "object": "a", "other": "b", "offset": [0, 0, 0.05]}
    assert match_goals([other], [{**other, "object": "x", "other": "y"}]).names == {"a": "x", "b": "y"}
    assert match_goals([other], [{**other, "object": "x", "other": "x"}]) is None


def test_offsets_have_a_direction_unless_they_are_short():
    over = {"kind": "at-object", "object": "a", "other": "b", "offset": [0, 0, 0.05]}
    assert match_goals([over], [{**over, "offset": [0, 0, 0.2]}]) is not None
    assert match_goals([over], [{**over, "offset": [0.05, 0, 0]}]) is None
    inside = {**over, "offset": [0, 0, 0]}
    assert match_goals([over], [inside]) is None
    assert match_goals([inside], [inside]) is not None


def test_things_to_be_left_alone_do_not_matter():
    assert match_goals([LIFTED], [LIFTED, {"kind": "undisturbed", "object": "mug"}]).names == {"box": "box"}


def test_a_manner_that_was_not_asked_for_then_is_told():
    still = {"kind": "still", "object": "box"}
    assert match_goals([LIFTED], [LIFTED, still]).missing == ("still",)
    assert match_goals([LIFTED, still], [LIFTED]).missing == ()


def test_what_must_not_be_touched_must_not_have_been_touched_then():
    assert match_goals([LIFTED], [LIFTED, UNTOUCHED]) is None
    assert match_goals([LIFTED, UNTOUCHED], [LIFTED]) is not None
    assert match_goals([LIFTED, UNTOUCHED], [LIFTED, UNTOUCHED]) is not None
    assert match_goals([LIFTED, UNTOUCHED], [LIFTED, {**UNTOUCHED, "thing": "table"}]) is None


def test_the_events_of_a_sequence_count_in_their_order():
    slid = {"kind": "slid", "object": "box", "thing": "table", "distance_m": 0.06}
    first = {"kind": "sequence", "object": "box", "events": [[slid], [LIFTED]]}
    farther = {**first, "events": [[{**slid, "distance_m": 0.1}], [LIFTED]]}
    assert match_goals([first], [farther]) is not None
    assert match_goals([first], [{**first, "events": [[LIFTED], [slid]]}]) is None


def test_tasks_without_any_goal_of_their_own_do_not_match():
    assert match_goals([UNTOUCHED], [UNTOUCHED]) is None


def test_things_are_numbered_as_the_goals_name_them(scene):
    facts = scene("pick-clutter").facts
    assert roles(facts["goals"]) == ["can", "mat"]
    numbers = scene_numbers(facts)
    assert [numbers[f"object0.size.{k}"] for k in range(3)] == facts["objects"]["can"]["size_m"]
    assert numbers["object1.size.2"] == 0.004
    assert numbers["object0.up"] == 2
    assert numbers["place.goal.1"] == -0.2
    assert "goal.at.object0.tolerance_m" not in numbers
    assert not [key for key in numbers if key.startswith("object2")]


def test_the_things_of_a_sequence_are_named_too(scene):
    assert roles(scene("push-pick-board").facts["goals"]) == ["board"]


def test_a_joint_is_known_by_its_object(scene):
    facts = scene("close-lid").facts
    numbers = scene_numbers(facts)
    assert joints_of(numbers, facts["goals"]) == {"lid": facts["objects"]["lid"]["joint"]["now"]}


def test_numbers_are_translated_to_the_names_of_another_scene(scene):
    facts = scene("pick-clutter").facts
    other = json.loads(json.dumps(facts).replace('"can"', '"tin2"').replace('"goal"', '"there"'))
    other["goals"] = other["goals"][1:4] + other["goals"][:1] + other["goals"][4:]
    names = {"can": "tin2", "mat": "mat", "goal": "there"}
    found = translate_numbers(scene_numbers(facts), facts["goals"], other["goals"], names)
    assert found == scene_numbers(other)


NUMBERS = {
    "object0.size.0": 0.1,
    "object0.mass_kg": 1.0,
    "object0.friction": 0.5,
    "object0.up": 2.0,
    "goal.lifted.object0.height_m": 0.1,
    "goal.at.object0.tolerance_m": 0.02,
    "place.goal.0": 0.1,
    "place.shelf.0": 0.3,
}


@pytest.mark.parametrize(
    ("change", "distance"),
    [
        ({}, 0.0),
        ({"object0.size.0": 0.25}, 1.0),
        ({"object0.mass_kg": 0.1}, 1.0),
        ({"object0.friction": 1.0}, 0.5),
        ({"goal.lifted.object0.height_m": 0.2}, 0.5),
        ({"goal.at.object0.tolerance_m": 0.2}, 0.0),
        ({"place.goal.0": 0.35}, 0.5),
        ({"place.shelf.0": -0.5}, 0.0),
        ({"object0.up": 0.0}, math.inf),
        ({"object0.size.0": 0.0}, math.inf),
        ({"another": 1.0}, 0.0),
    ],
)
def test_the_largest_difference_counts_relative_to_its_limit(change, distance):
    found = scene_distance(NUMBERS, {**NUMBERS, **change}, frozenset({"goal"}))
    assert found == pytest.approx(distance)


@pytest.mark.parametrize(
    ("size", "up", "fits"), [((0.07, 0.2, 0.2), 2, True), ((0.2, 0.2, 0.05), 2, False), ((0.2, 0.2, 0.05), 0, True)]
)
def test_the_fingers_close_from_above_around_a_narrow_side(size, up, fits):
    numbers = {f"object0.size.{k}": value for k, value in enumerate(size)} | {"object0.up": float(up)}
    assert fits_hand(numbers, "object0") is fits
