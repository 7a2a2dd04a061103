"""The numbers of a scene, and how far two scenes differ."""

import json
import math

import pytest

from coral.contact.memory.scene_numbers import (
    fits_hand,
    joints_of,
    roles,
    scene_distance,
    scene_numbers,
    translate_numbers,
)


def test_things_are_numbered_as_the_goals_name_them(scene):
    facts = scene("pick-clutter").facts
    assert roles(facts["goals"]) == ["can", "mat"]
    numbers = scene_numbers(facts)
    assert [numbers[f"object0.size.{k}"] for k in range(3)] == facts["objects"]["can"]["size_m"]
    assert numbers["object1.size.2"] == 0.004
    assert numbers["object0.up"] == 2
    assert numbers["place.goal.1"] == -0.2
    assert numbers["goal.at.object0.tolerance_m"] == 0.05
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
