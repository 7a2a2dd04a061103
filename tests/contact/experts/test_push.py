"""Pushing with a steady force: where the hand pushes, how hard it can, and what of its target is left alone."""

from dataclasses import replace

import numpy as np
import pytest

from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.experts.push import SOFT_N_M, ahead_of, behind, fsm, recent
from coral.contact.experts.terms import DOWN
from coral.contact.scene.geometry import angle_between
from coral.contact.scene.observation import BodyState, Observation
from coral.contact.scene.trial import sample_trial, stated_beliefs
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.mppi.knots import KnotMppiCfg

TASK = load_task("push-force")
_, PUSH, LET_GO = fsm(TASK).stages


def at_the_block(seed):
    """A trial, and what is seen with the hand behind the block, touching nothing."""
    trial = sample_trial(TASK, seed)
    start = HandWorld(trial).reset()
    world = PlanningWorld(trial, stated_beliefs(trial), start, PlanningCfg(threads=1))
    place = behind(world.present(start), "block", 0.005)[0, 0]
    tool = BodyState(place, DOWN, np.zeros(3), np.zeros(3))
    return world, Observation(0.0, tool, 0.03, np.zeros(6), start.objects)


def test_the_mean_is_over_the_last_steps_and_at_first_over_those_there_are():
    values = np.arange(30.0).reshape(1, 30, 1)
    found = recent(values)[0, :, 0]
    assert found[:3] == pytest.approx([0.0, 0.5, 1.0])
    assert found[[9, 10, 29]] == pytest.approx([4.5, 5.5, 24.5])


def test_the_spring_moves_the_heaviest_block_and_cannot_push_much_harder_than_wanted():
    most = SOFT_N_M * ControllerCfg().lead_m
    wanted = next(one for one in TASK.success.conditions if one.kind == "steady-force")
    block = TASK.object("block")
    assert most > 1.3 * max(block.mass_kg) * max(block.friction) * 9.81
    assert most < 1.1 * wanted.newtons * (1 + wanted.tolerance)


def test_the_guides_lie_on_the_line_to_the_goal_and_below_the_blocks_top():
    world, now = at_the_block(2)
    high = replace(now, tool=replace(now.tool, position=now.tool.position + np.array([0, 0, 0.1])))
    points = ahead_of(world.present(high), "block")
    way = np.array([0.14, 0.0]) - now.objects["block"].position[:2]
    off = points[:, :2] - now.tool.position[:2]
    assert (off @ way).min() > 0.03 * np.linalg.norm(way)
    assert np.abs(off[:, 0] * way[1] - off[:, 1] * way[0]).max() < 1e-3
    assert points[:, 2].max() < now.objects["block"].position[2] + world.present(now).block_size[0, 0, 2] / 2


@pytest.mark.parametrize("seed", range(4))
def test_the_palm_stays_above_the_block_and_the_fingertips_above_the_table(seed):
    world, now = at_the_block(seed)
    top = now.objects["block"].position[2] + world.present(now).block_size[0, 0, 2] / 2
    assert now.tool.position[2] + 0.037 > top + 0.005
    assert now.tool.position[2] - 0.008 > 0.005


def test_a_push_goes_ahead_and_leaves_height_orientation_and_opening_alone():
    world, now = at_the_block(0)
    planner = Controller(world, ControllerCfg(mppi=KnotMppiCfg(samples=40)), np.random.default_rng(0))
    latest = None
    for _ in range(10):
        plan = planner.plan(now, PUSH, 0, None, latest, 2 if latest else 0)
        latest = plan.targets[1]
    last = plan.targets[-1]
    assert last.position[0] > now.tool.position[0] + 0.004
    assert -0.005 < last.position[2] - now.tool.position[2] < 0.002  # SINK_M lower
    assert angle_between(last.quaternion, now.tool.quaternion) < 0.02
    assert last.opening_m == pytest.approx(now.opening_m)


def test_the_hand_lets_go_although_the_plan_before_leads_over_the_block():
    world, now = at_the_block(0)
    planner = Controller(world, ControllerCfg(mppi=KnotMppiCfg(samples=40)), np.random.default_rng(0))
    planner.reset(now)
    ahead = np.linspace(0.0, 1.0, len(planner.mppi.knots))
    planner.mppi.knots[:, :3] += ahead[:, None] * np.array([0.15, 0.0, 0.05])
    latest = None
    for _ in range(4):
        plan = planner.plan(now, LET_GO, 0, None, latest, 2 if latest else 0)
        latest = plan.targets[1]
    assert plan.targets[-1].position[0] < now.tool.position[0] - 0.01
