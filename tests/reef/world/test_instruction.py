"""Conditions of missions in words, each with near misses."""

from __future__ import annotations

import dataclasses
import math

import pytest

from coral.reef.world.instruction import (
    Answered,
    Deeds,
    DoneBy,
    EndsAt,
    InOrder,
    Inspected,
    KeptOff,
    MissionText,
    Sides,
    Spared,
    apart,
    spoken,
)

KINDS = {
    "a": "living-clump",
    "b": "living-clump",
    "net": "ghost-net",
    "t": "tyre",
    "weed": "sea-grass",
    "cut": "cable-damage",
}
SEEN = {"a": 10.0, "t": 20.0, "b": 30.0, "weed": 5.0}
NET = ("ghost-net",)
LIVING = ("living-clump",)


def deeds(**changed):
    return dataclasses.replace(Deeds(kinds=KINDS, inspected_s=SEEN), **changed)


@pytest.mark.parametrize(
    ("clause", "done", "met"),
    [
        (Inspected(of=LIVING), {}, True),
        (Inspected(of=LIVING), {"inspected_s": {"a": 10.0}}, False),
        (Inspected(of=LIVING, share=0.5), {"inspected_s": {"a": 10.0}}, True),
        (Inspected(of=("b",), count=1), {"inspected_s": {"a": 10.0}}, False),
        (Spared(besides=LIVING, at_most=1), {}, True),  # the tyre; sea grass is floor to the robot
        (Spared(besides=LIVING), {}, False),
        (KeptOff(of=NET, distance_m=2.0), {"nearest_m": {"net": 2.0}}, True),
        (KeptOff(of=NET, distance_m=2.0), {"nearest_m": {"net": 1.99}}, False),
        (Sides(of=NET, count=3), {"seen_from": {"net": [(4.0, 0.0), (4.0, 1.1), (4.0, 2.2)]}}, True),
        (Sides(of=NET, count=3), {"seen_from": {"net": [(4.0, 0.0), (4.0, 1.0), (4.0, 2.0)]}}, False),
        (Sides(of=NET, count=3), {"seen_from": {"net": [(4.0, 0.0), (4.0, 1.1), (5.1, 2.2)]}}, False),
        (InOrder(of=("a", "tyre", "b")), {}, True),
        (InOrder(of=("tyre", "a")), {}, False),
        (InOrder(of=("a", "net")), {}, False),
        (EndsAt(), {"from_start_m": 2.5}, True),
        (EndsAt(), {"from_start_m": 2.6}, False),
        (EndsAt(at="cable-damage", within_m=3.0), {"from_m": dict.fromkeys(KINDS, 2.9)}, True),
        (DoneBy(time_s=100.0), {"done": True, "end_s": 100.0}, True),
        (DoneBy(time_s=100.0), {"done": True, "end_s": 101.0}, False),
        (DoneBy(time_s=100.0), {"end_s": 50.0}, False),
        (Answered(right=("4",)), {"answer": "There are four reef balls."}, True),
        (Answered(right=("4",)), {"answer": "4 or 5"}, False),
        (Answered(right=("4",)), {"answer": "14"}, False),
        (Answered(right=("4",)), {}, False),
        (Answered(right=("north",), wrong=("south",)), {"answer": "The northern one: North."}, True),
        (Answered(right=("north",), wrong=("south",)), {"answer": "north or south"}, False),
    ],
)
def test_a_condition_is_met_or_just_missed(clause, done, met):
    assert clause.judge(deeds(**done))[0] is met


def test_one_thing_too_many_is_counted_as_one():
    assert Spared(besides=LIVING).judge(deeds())[1] == "1 other inspected, 0 allowed"


def test_a_mission_lists_what_was_found_of_each_condition():
    text = MissionText(instruction="Inspect both.", conditions=(Inspected(of=LIVING), EndsAt()))
    verdict = text.judge(deeds(from_start_m=7.0))
    assert [(one.condition, one.met) for one in verdict] == [("inspected", True), ("ends_at", False)]
    assert verdict[1].found == "7.0 m away, 2.5 m allowed"


def test_directions_count_once_round_the_circle():
    assert apart([math.radians(a) for a in (0, 60, 120, 180, 240, 300)]) == 6
    assert apart([math.radians(a) for a in (350, 10, 180)]) == 2
    assert apart([]) == 0


def test_numbers_in_words_are_numbers():
    assert spoken("Three, or 12!") == ["3", "or", "12"]
