"""Rollouts by MuJoCo Warp, on its CPU device, against MuJoCo's own; `make test-warp`."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from coral.contact.control.planning_world import ControlSequences, PlanningCfg, PlanningWorld
from coral.contact.control.warp_rollouts import WarpRollouts
from coral.contact.scene.trial import sample_trial, stated_beliefs
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.errors import InputError

ROLLOUTS, STEPS = 4, 40
"""Rollouts under each of two beliefs, and their control steps."""


def begin(name):
    trial = sample_trial(load_task(name), 0, name)
    real = HandWorld(trial)
    now = real.reset()
    real.close()
    return trial, now


def towards_the_object(now, seed=1):
    """Sequences that lead the open hand into the first object within half a second, each a little elsewhere."""
    rng = np.random.default_rng(seed)
    near = next(iter(now.objects.values())).position + rng.normal([0.03, 0.02, 0.0], 0.02, (ROLLOUTS, 3))
    share = np.minimum(1.0, np.linspace(0.0, 2.0, STEPS))[None, :, None]
    return ControlSequences(
        now.tool.position + share * (near[:, None] - now.tool.position),
        np.tile(now.tool.quaternion, (ROLLOUTS, STEPS, 1)),
        np.full((ROLLOUTS, STEPS), 0.08),
        600.0,
    )


@pytest.fixture
def worlds():
    made = []

    def make(trial, now, **cfg):
        beliefs = [stated_beliefs(trial)] * 2
        beliefs[1] = {
            name: type(one)(2.0 * one.mass_kg, 0.5 * one.friction)  # another model: half of the rollouts believe it
            for name, one in beliefs[0].items()
        }
        made.append(PlanningWorld(trial, beliefs, now, PlanningCfg(rest_m_s=0.0, **cfg)))
        return made[-1]

    yield make
    for world in made:
        world.close()


@pytest.mark.warp
@pytest.mark.parametrize("name", ["pick-box", "push-force", "flip-wall"])
def test_rollouts_agree_in_the_air_exactly_and_in_contact_to_millimetres(name, worlds):
    trial, now = begin(name)
    controls = towards_the_object(now)
    ours, good = worlds(trial, now).rollout(now, controls)
    other, fine = worlds(trial, now, rollouts="warp", device="cpu").rollout(now, controls)
    assert good.all()
    assert fine.all()
    item = next(iter(trial.objects))
    assert (ours["ee_pos"] != other["ee_pos"]).any(), "single precision cannot agree bit for bit: Warp did not run"
    touched = ours[f"{item}_hand_contact"].any(axis=1)
    assert touched.any(), "no rollout touches the object: nothing is compared"
    # Where a table has edges, Warp finds other contact points between boxes: a resting box settles otherwise by 0.7 mm.
    for quantity, in_the_air in (("ee_pos", 1e-6), (f"{item}_pos", 1e-3)):
        apart = np.abs(ours[quantity] - other[quantity]).max(axis=2)
        assert apart[:, :15].max() < in_the_air, quantity
        assert np.sort(apart.max(axis=1))[-2] < 4e-3, quantity  # one grasp in eight slips in the one and not the other
    assert np.mean(ours[f"{item}_hand_contact"] != other[f"{item}_hand_contact"]) < 0.05
    assert np.ptp(ours[f"{item}_pos"], axis=1).max() > 0.005


@pytest.mark.warp
def test_a_hand_that_presses_on_the_table_feels_the_same_force(worlds):
    trial, now = begin("pick-box")
    low = np.array([-0.25, -0.3, 0.008])
    now = replace(now, tool=replace(now.tool, position=low + np.array([0.0, 0.0, 0.005])), opening_m=0.0)
    down = ControlSequences(
        np.tile(low - np.array([0.0, 0.0, 0.02]), (2, STEPS, 1)),
        np.tile(now.tool.quaternion, (2, STEPS, 1)),
        np.zeros((2, STEPS)),
        600.0,
    )
    ours, other = (
        worlds(trial, now, **cfg).rollout(now, down)[0] for cfg in ({}, {"rollouts": "warp", "device": "cpu"})
    )
    assert ours["ee_force"][0, -1, 2] == pytest.approx(12.0, rel=0.1)
    assert other["ee_force"][:, -1] == pytest.approx(ours["ee_force"][:, -1], abs=0.1)


@pytest.mark.warp
def test_another_stiffness_and_start_are_taken_over(worlds):
    trial, now = begin("pick-box")
    world = worlds(trial, now, rollouts="warp", device="cpu")
    controls = towards_the_object(now)
    first, _ = world.rollout(now, controls)
    soft = ControlSequences(controls.position, controls.quaternion, controls.opening, 200.0)
    softly, _ = world.rollout(now, soft)
    again, _ = world.rollout(now, controls)
    assert np.abs(first["ee_pos"] - softly["ee_pos"]).max() > 0.01
    assert again["ee_pos"] == pytest.approx(first["ee_pos"], abs=1e-5)


@pytest.mark.warp
def test_single_rollouts_between_plans_leave_the_device_as_it_is(worlds):
    trial, now = begin("pick-box")
    world = worlds(trial, now, rollouts="warp", device="cpu")
    controls = towards_the_object(now)
    world.rollout(now, controls)
    before = [id(one.data) for one in world._rollouts._kept.values()]
    present = world.present(now)
    world.rollout(now, controls)
    assert [id(one.data) for one in world._rollouts._kept.values()] == before
    same = worlds(trial, now).present(now)
    assert np.array_equal(present["box_pos"], same["box_pos"])


@pytest.mark.warp
def test_a_device_that_is_not_there_is_named():
    with pytest.raises(InputError, match=r"planning\.device: found 'cuda:7', expected one of .*cpu"):
        WarpRollouts("cuda:7")


def test_without_the_package_it_is_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco_warp", None)
    with pytest.raises(InputError, match=r"planning\.rollouts: found warp .*the extra warp"):
        WarpRollouts()
