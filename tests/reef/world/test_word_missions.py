"""Missions in words by name."""

from __future__ import annotations

import math

import pytest

from coral.errors import InputError
from coral.reef.world.generated import expand_names, find_world
from coral.reef.world.word_missions import APART_M, FAMILIES, word_mission


@pytest.mark.parametrize("family", list(FAMILIES))
def test_a_family_has_other_words_for_tests_and_other_places_by_number(family):
    worlds = [word_mission(f"words:{family}:{number}") for number in (0, 1, 100, 101)]
    assert len({world.mission.instruction for world in worlds}) == 4
    assert len({world.things for world in worlds}) == 4
    assert word_mission(f"words:{family}:0") == worlds[0]
    for world in worlds:
        places = [(one.x, one.y) for one in world.things if not one.kind.startswith("cable")]
        assert all(math.dist(a, b) >= APART_M - 0.02 for k, a in enumerate(places) for b in places[:k])
        named = {thing.name for thing in world.things} | {thing.kind for thing in world.things}
        for clause in world.mission.conditions:
            assert set(getattr(clause, "of", ())) <= named


def test_a_wrong_name_gets_the_nearest_family():
    with pytest.raises(InputError, match="cable"):
        find_world("words:cabel:1")


def test_a_range_names_missions_family_by_family():
    assert expand_names(["words:net:0-1"]) == ("words:net:0", "words:net:1")
    assert len(expand_names(["words:all:100-103"])) == 32
