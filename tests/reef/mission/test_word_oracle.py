"""The way of the oracle of missions in words."""

import itertools
import math

import pytest

from coral.reef.generator.word_missions import word_mission
from coral.reef.mission.word_oracle import _targets, true_answer, word_tour
from coral.reef.vehicle.tour_kernels import advance
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.geometry import Pose


def test_it_knows_the_right_answer():
    world = word_mission("words:count:0")
    assert true_answer(world) == str(sum(thing.kind == "reef-ball" for thing in world.things))
    assert true_answer(word_mission("words:net:0")) == ""


def test_it_goes_to_what_the_conditions_name_in_order():
    world = word_mission("words:order:0")
    targets, names, _ = _targets(world, (2.5, 10.0))
    at = {thing.kind: (thing.x, thing.y) for thing in world.things if thing.name == thing.kind}
    assert targets == [at["crab-pot"], at["tyre"], at["sponge"]]
    assert names == ["crab-pot", "tyre", "sponge"]


@pytest.mark.parametrize("number", [102, 103])
def test_it_keeps_clear_of_what_comes_later_in_an_order_and_arrives(number):
    world, vehicle = word_mission(f"words:order:{number}"), VehicleCfg()
    commands, passed = word_tour(world, vehicle, 0.1), []
    pose = Pose(world.start.x, world.start.y, world.start.theta)
    at = {thing.kind: (thing.x, thing.y) for thing in world.things}
    for speed, rate in commands:
        pose = Pose(*advance(*pose, speed, rate, 0.1))
        passed += [kind for kind in ("crab-pot", "tyre", "sponge") if math.dist(pose[:2], at[kind]) < 1.6]
    assert [kind for kind, _ in itertools.groupby(passed)] == ["crab-pot", "tyre", "sponge"]
    assert len(commands) < 1200


def test_it_follows_a_cable_from_end_to_end():
    targets, *_ = _targets(word_mission("words:cable:101"), (2.5, 10.0))
    assert [x for x, _ in targets] == sorted(x for x, _ in targets)  # the file has the fourth piece before the third


def test_it_sees_three_sides_from_beyond_the_distance_to_keep():
    world = word_mission("words:net:0")
    net = next(thing for thing in world.things if thing.kind == "ghost-net")
    targets, *_ = _targets(world, (2.5, 10.0))
    assert min(math.dist(target, (net.x, net.y)) for target in targets) == pytest.approx(3.4)
