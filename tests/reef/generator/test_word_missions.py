"""Missions in words by name."""

from __future__ import annotations

import math
import re

import pytest

from coral.errors import InputError
from coral.reef.generator.word_missions import APART_M, FAMILIES, word_mission
from coral.reef.world.find_world import expand_names, find_world
from coral.reef.world.instruction import Deeds, DoneBy, Inspected, KeptOff, Sides, Spared, spoken
from coral.reef.world.kinds import find_kind


@pytest.mark.parametrize("family", list(FAMILIES))
def test_a_family_has_other_words_for_tests_and_other_places_by_number(family):
    worlds = [word_mission(f"words:{family}:{number}") for number in (0, 1, 100, 101)]
    assert len({world.mission.instruction for world in worlds}) == 4
    assert len({world.things for world in worlds}) == 4
    assert word_mission(f"words:{family}:0") == worlds[0]
    for world in worlds:
        places = [(one.x, one.y) for one in world.things if find_kind(one.kind).class_ == "oyster"]
        assert all(math.dist(a, b) >= APART_M - 0.02 for k, a in enumerate(places) for b in places[:k])
        named = {thing.name for thing in world.things} | {thing.kind for thing in world.things}
        for clause in world.mission.conditions:
            assert set(getattr(clause, "of", ())) <= named


@pytest.mark.parametrize("name", expand_names(["words:all:0-1", "words:all:100-101"]))
def test_the_words_and_the_judge_have_the_same_numbers(name):
    text = word_mission(name).mission
    words = " ".join(spoken(text.instruction))
    for clause in text.conditions:
        match clause:
            case KeptOff(distance_m=metres):
                assert re.search(rf"\b({metres:g}|a) m(etre)?\b", words)
            case Spared(at_most=number):
                assert re.search(rf"\b({number}|{'twice' if number == 2 else number})\b", words)
            case Sides(count=number) | Inspected(count=int(number)):
                assert f"{number} " in words
            case DoneBy(time_s=seconds) if "seconds" in words or "minutes" in words:
                assert f"{seconds:g} seconds" in words or f"{seconds / 60:g} minutes" in words
            case _:
                pass


@pytest.mark.parametrize("number", [1, 101])
def test_a_mission_asks_for_the_plot_of_the_fish_and_other_animals_keep_to_the_others(number):
    world = word_mission(f"words:plots:{number}")
    assert re.search("fish|shoal", world.mission.instruction)
    home = {
        animal.kind: next(
            one for one in world.things if one.name != animal.name and (one.x, one.y) == (animal.x, animal.y)
        )
        for animal in world.things
        if find_kind(animal.kind).circles
    }
    assert {plot.name for plot in home.values()} == {"north", "east", "south"}
    assert home["ray"].kind == "plot-old"  # where fish would be expected
    inspected = {plot.name: 10.0 for plot in home.values()}
    for animal, right in {"fish": True, "crab": False, "ray": False}.items():
        deeds = Deeds(
            kinds={thing.name: thing.kind for thing in world.things},
            inspected_s=inspected,
            end_s=300.0,
            done=True,
            answer=f"the {home[animal].name} plot",
        )
        assert all(one.met for one in world.mission.judge(deeds)) is right


def test_a_wrong_name_gets_the_nearest_family():
    with pytest.raises(InputError, match="cable"):
        find_world("words:cabel:1")


def test_a_range_names_missions_family_by_family():
    assert expand_names(["words:net:0-1"]) == ("words:net:0", "words:net:1")
    assert len(expand_names(["words:all:100-103"])) == 32
