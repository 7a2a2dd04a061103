"""The way of the oracle of missions in words."""

import math

import pytest

from coral.reef.mission.word_oracle import _targets, next_things, true_answer
from coral.reef.world.word_missions import word_mission


def test_it_knows_the_right_answer():
    world = word_mission("words:count:0")
    assert true_answer(world) == str(sum(thing.kind == "reef-ball" for thing in world.things))
    assert true_answer(word_mission("words:net:0")) == ""


def test_it_goes_to_what_the_conditions_name_in_order():
    world = word_mission("words:order:0")
    targets, names = _targets(world, (2.5, 10.0))
    at = {thing.kind: (thing.x, thing.y) for thing in world.things if thing.name == thing.kind}
    assert targets == [at["crab-pot"], at["tyre"], at["sponge"]]
    assert names == {"crab-pot", "tyre", "sponge"}


def test_it_follows_a_cable_from_end_to_end():
    targets, _ = _targets(word_mission("words:cable:101"), (2.5, 10.0))
    assert [x for x, _ in targets] == sorted(x for x, _ in targets)  # the file has the fourth piece before the third


def test_it_sees_three_sides_from_beyond_the_distance_to_keep():
    world = word_mission("words:net:0")
    net = next(thing for thing in world.things if thing.kind == "ghost-net")
    targets, _ = _targets(world, (2.5, 10.0))
    assert min(math.dist(target, (net.x, net.y)) for target in targets) == pytest.approx(3.4)


def test_what_is_next_depends_on_what_was_seen_and_on_the_order():
    world = word_mission("words:order:0")
    named = next(one.of for one in world.mission.conditions if one.kind == "in_order")
    order = [next(thing.name for thing in world.things if one in (thing.kind, thing.name)) for one in named]
    assert next_things(world, ()) == {order[0]}
    assert next_things(world, order[:1]) == {order[1]}
    assert next_things(world, (), in_order=False) == set(order)
    assert next_things(world, order) == set()
