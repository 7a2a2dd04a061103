"""More samples for a planner that is stuck: when they help, when not, and what is left as it was."""

import numpy as np
import pytest
from contact_bench import make_trial, seen

from coral.config import checked
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_effort import EffortCfg, probe_effort
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.cost.stages import Stage
from coral.contact.scene.prior_beliefs import stated_beliefs
from coral.mppi.knots import KnotMppiCfg

GOAL = np.array([0.1, 0.1, 0.2])
REACH = Stage("reach", lambda state: {"reach": np.linalg.norm(state.ee_pos - GOAL, axis=-1)})
NOTHING_LEFT = Stage("stay", lambda state: {"stay": np.ones((1, 1))})


@pytest.fixture
def planner():
    trial = make_trial()
    world = PlanningWorld(trial, stated_beliefs(trial), seen(trial), PlanningCfg(threads=1))
    cfg = ControllerCfg(horizon=12, mppi=KnotMppiCfg(samples=2, knots=3))
    yield Controller(world, cfg, np.random.default_rng(0))
    world.close()


def test_retries_can_be_switched_off():
    assert checked(EffortCfg(retries=0), "--cfg").retries == 0


def test_two_samples_are_too_few_for_a_reach(planner):
    now = seen(make_trial())
    planner.plan(now, REACH, 0)
    found = probe_effort(planner, now, REACH, 0, EffortCfg(factor=20, plans=6))
    assert (found.samples, found.more) == (2, 40)
    assert found.gain > 0.1
    assert found.gain == pytest.approx((found.cost - found.lower) / found.cost)
    assert "With 40 samples in place of 2" in found.sentence()


def test_where_no_plan_is_better_nothing_is_gained(planner):
    now = seen(make_trial())
    planner.plan(now, NOTHING_LEFT, 0)
    assert probe_effort(planner, now, NOTHING_LEFT, 0, EffortCfg()).gain == pytest.approx(0.0)


def test_a_probe_leaves_the_planner_as_it_was(planner):
    now = seen(make_trial())
    planner.plan(now, REACH, 0)
    before = planner.mppi.knots.copy()
    first, second = (probe_effort(planner, now, REACH, 0, EffortCfg()) for _ in range(2))
    assert (planner.mppi.knots == before).all()
    assert planner.mppi.cfg.samples == 2
    assert first.lower == second.lower  # one moment, one verdict


def test_the_stronger_planner_is_adopted_with_its_plan(planner):
    now = seen(make_trial())
    planner.plan(now, REACH, 0)
    found = probe_effort(planner, now, REACH, 0, EffortCfg())
    planner.adopt(found.stronger)
    plan = planner.plan(now, REACH, 0)
    assert len(plan.update.costs) == 8
    assert plan.update.costs[0] == pytest.approx(found.lower, rel=0.2)
