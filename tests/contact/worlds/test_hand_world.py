"""The light evaluation world: impedance, sensors, judge's contacts, and failure."""

import dataclasses

import numpy as np
import pytest
from episodes import make_trial

from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.hand_world import HandWorld
from coral.contact.worlds.robot_world import WorldError


@pytest.fixture
def world():
    return HandWorld(make_trial())


def hold(now, **changes):
    return dataclasses.replace(HandTarget(now.tool.position, now.tool.quaternion, now.opening_m, 600.0), **changes)


def settle(world, target, steps=100):
    for _ in range(steps):
        now = world.step(target)
    return now


def test_a_force_displaces_the_hand_as_its_stiffness_says(world):
    start = world.reset()
    now = settle(world, hold(start, force=np.array([3.0, 0.0, 0.0])))
    assert now.time_s == pytest.approx(2.0)
    np.testing.assert_allclose(now.tool.position - start.tool.position, [3.0 / 600.0, 0.0, 0.0], atol=3e-4)


def test_reset_begins_the_same_episode_again(world):
    first = world.reset()
    settle(world, hold(first, position=first.tool.position + np.array([0.05, 0.0, -0.1])), 20)
    again = world.reset()
    assert again.time_s == 0.0
    np.testing.assert_array_equal(again.tool.position, first.tool.position)
    np.testing.assert_array_equal(again.objects["box"].position, first.objects["box"].position)


def test_a_hand_that_presses_on_the_table_feels_it_and_the_judge_sees_it(world):
    start = world.reset()
    place = np.array([start.tool.position[0], start.tool.position[1], 0.0])
    now = settle(world, hold(start, position=place), 100)
    now = settle(world, hold(start, position=now.tool.position - [0.0, 0.0, 0.01]), 100)
    assert now.wrench[2] > 3.0
    pairs = {(contact.first, contact.second) for contact in world.truth().contacts}
    assert pairs & {("left", "table"), ("right", "table"), ("hand", "table")}


def test_a_simulation_that_diverges_ends_by_name(world):
    now = world.reset()
    simulation = world.simulation
    simulation.data.qvel[simulation.model.joint("box_free").dofadr[0]] = np.nan
    with pytest.raises(WorldError, match="diverged") as error:
        world.step(hold(now))
    assert error.value.code == "diverged"
