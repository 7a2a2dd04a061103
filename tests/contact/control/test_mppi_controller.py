"""The planner of hand motions on a reach: better plans, within bounds, the same for the same seed."""

from dataclasses import replace

import numpy as np
import pytest
from contact_bench import make_trial, seen

from coral.contact.control.hand_model import FLANGE_TO_TOOL_M, MAX_OPENING_M
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_world import PlanningCfg, PlanningWorld
from coral.contact.control.prediction import state_after
from coral.contact.cost.stages import Guide, Progress, Stage, Strategy
from coral.contact.scene.geometry import angle_between, from_rotvec, multiply
from coral.contact.scene.trial import stated_beliefs
from coral.mppi.knots import KnotMppiCfg

GOAL = np.array([0.1, 0.1, 0.2])
CFG = ControllerCfg(horizon=12, mppi=KnotMppiCfg(samples=24, knots=3))
REACH = Stage("reach", lambda state: {"reach": np.linalg.norm(state.ee_pos - GOAL, axis=-1)})


def controller(cfg=CFG, seed=0):
    trial = make_trial()
    world = PlanningWorld(trial, stated_beliefs(trial), seen(trial), PlanningCfg(threads=1))
    return Controller(world, cfg, np.random.default_rng(seed)), seen(trial)


def replanned(planner, now, times=6, stage=REACH):
    return [planner.plan(now, stage, 0) for _ in range(times)]


def test_replanning_betters_the_plan():
    plans = replanned(*controller(), times=10)
    costs = [plan.update.costs[0] for plan in plans]  # of the plan before
    assert costs[-1] < costs[0] - 0.05
    assert min(costs) == costs[-1]
    assert plans[-1].targets[-1].position @ (GOAL - [-0.1, 0, 0.25]) > plans[0].targets[0].position @ (
        GOAL - [-0.1, 0, 0.25]
    )


def test_targets_keep_to_speed_workspace_and_opening():
    cfg = replace(
        CFG, sigma_m=(1.0, 1.0, 1.0), sigma_rad=(3.0, 3.0, 3.0), sigma_opening_m=1.0, workspace_low_m=(-0.11, -1, 0.2)
    )
    planner, now = controller(cfg)
    for plan in replanned(planner, now, 3):
        positions = np.array([now.tool.position, *(target.position for target in plan.targets)])
        turns = np.array([now.tool.quaternion, *(target.quaternion for target in plan.targets)])
        openings = np.array([now.opening_m, *(target.opening_m for target in plan.targets)])
        step = planner.world.cfg.step_s
        assert np.linalg.norm(np.diff(positions, axis=0), axis=1).max() <= cfg.speed_m_s * step + 1e-9
        assert angle_between(turns[1:], turns[:-1]).max() <= cfg.turn_rad_s * step + 1e-6
        assert np.abs(np.diff(openings)).max() <= cfg.opening_m_s * step + 1e-9
        assert positions[:, 0].min() >= -0.11 - 1e-9
        assert positions[:, 2].min() >= 0.2 - 1e-9
        assert openings.min() >= 0
        assert openings.max() <= MAX_OPENING_M


def test_the_hand_is_led_away():
    planner, now = controller(CFG)
    target = None
    for step in range(5):
        target = planner.plan(now, REACH, step, None, target, 2 if step else 0).targets[1]
        now = replace(now, tool=replace(now.tool, position=target.position))
    assert np.linalg.norm(now.tool.position - GOAL) < np.linalg.norm(seen(make_trial()).tool.position - GOAL) - 0.03


def test_the_wrist_is_led_no_further_than_the_arm_reaches():
    away = Stage("away", lambda state: {"away": -state.ee_pos[..., 0]})
    wrists = {}
    for reach in (0.5, 0.0):
        planner, now = controller(replace(CFG, reach_m=reach, sigma_m=(0.3, 0.3, 0.3), sigma_rad=(0.0, 0.0, 0.0)))
        latest = None
        for step in range(8):
            plan = planner.plan(now, away, step, None, latest, 2 if step else 0)
            latest = plan.targets[1]
            now = replace(now, tool=replace(now.tool, position=plan.targets[1].position))
        ends = np.array([target.position for target in plan.targets]) - np.array([0, 0, -FLANGE_TO_TOOL_M])
        wrists[reach] = np.linalg.norm(ends - CFG.shoulder_m, axis=1).max()
    assert wrists[0.5] == pytest.approx(0.5, abs=0.005)
    assert wrists[0.0] > 0.55


def test_the_next_plan_begins_where_the_last_one_was_left():
    planner, now = controller()
    plan = replanned(planner, now)[-1]
    left = plan.targets[2]
    planner._sigma = np.zeros(7)
    again = planner.plan(replace(now, tool=replace(now.tool, position=left.position)), REACH, 3, None, left, 3)
    assert again.targets[0].position == pytest.approx(plan.targets[3].position, abs=5e-3)
    assert again.targets[5].position == pytest.approx(plan.targets[8].position, abs=5e-3)


def test_the_target_does_not_run_ahead_of_a_hand_that_is_held():
    planner, now = controller()
    planner.reset(now)
    ahead = replace(planner._target, position=now.tool.position + np.array([0.5, 0, 0]))
    plan = planner.plan(now, REACH, 1, None, ahead, 1)
    assert np.linalg.norm(plan.update.sampled[0, 0, :3] - now.tool.position) == pytest.approx(CFG.lead_m)


def test_same_seed_same_plan_bit_for_bit():
    first, second = (replanned(*controller(seed=3), 2)[-1] for _ in range(2))
    assert np.array_equal(first.update.knots, second.update.knots)
    assert first.terms == second.terms


def test_where_no_rollout_counts_the_plan_is_kept():
    planner, now = controller()
    before = planner.plan(now, REACH, 0)
    plan = planner.plan(now, replace(REACH, cost=lambda state: {"x": np.full(state.shape, np.nan)}), 0)
    assert not plan.update.ok
    assert plan.update.knots == pytest.approx(before.update.knots, abs=1e-12)
    assert np.linalg.norm(plan.expected_position[0] - now.tool.position) < 0.02


def test_a_cost_without_a_value_somewhere_spoils_only_that_rollout():
    def cost(state):
        value = np.linalg.norm(state.ee_pos - GOAL, axis=-1)
        value[5] = np.nan
        return {"reach": value}

    planner, now = controller()
    plan = planner.plan(now, replace(REACH, cost=cost), 0)
    assert plan.update.weights[5] == 0
    assert np.isfinite(plan.cost)


def test_terms_are_the_plans_expected_cost():
    planner, now = controller()
    plan = planner.plan(now, REACH, 0)
    assert plan.cost == pytest.approx(plan.update.weights @ plan.update.costs)


def test_guided_samples_head_for_their_point():
    guide = Guide(lambda state: GOAL[None], opening_m=0.01)
    planner, now = controller(replace(CFG, guided=0.5))
    plan = planner.plan(now, replace(REACH, guides=(guide,)), 0)
    gap = np.linalg.norm(plan.update.sampled[:, -1, :3] - GOAL, axis=-1)
    assert gap[12:].mean() < gap[:12].mean() - 0.05


def test_stages_follow_each_other_and_fall_back():
    said = {"done": False, "lost": False}
    progress = Progress(
        Strategy(
            "two",
            (
                Stage("first", REACH.cost, until=lambda now: said["done"]),
                Stage("second", REACH.cost, until=lambda now: True, next=(("first", lambda now: said["lost"]),)),
            ),
        )
    )
    assert not progress.update(None)
    said["done"] = True
    assert progress.update(None)
    assert progress.stage.name == "second"
    assert not progress.update(None)  # the last stage stays
    said["lost"] = True
    assert progress.update(None)
    assert progress.stage.name == "first"


DIVE = Stage("dive", lambda state: {"down": np.abs(state.ee_pos[..., 2] + 0.05)})


def pressed_n(stage):
    """How hard the planned hand presses on the table once it is there, N."""
    trial = make_trial()
    now = seen(trial, tool=(-0.15, -0.15, 0.03), opening_m=0.02)
    world = PlanningWorld(trial, stated_beliefs(trial), now, PlanningCfg(threads=1))
    planner = Controller(world, replace(CFG, mppi=KnotMppiCfg(samples=48, knots=3)), np.random.default_rng(0))
    latest = None
    for step in range(12):
        plan = planner.plan(now, stage, step, None, latest, 2 if step else 0)
        now = state_after(world, now, plan.targets[:2], step)
        latest = plan.targets[1]
    world.close()
    return float(np.linalg.norm(plan.expected_force, axis=-1).mean())


def test_a_stage_that_keeps_off_does_not_press_hard_on_the_table():
    assert pressed_n(DIVE) > 20.0
    assert pressed_n(replace(DIVE, keeps_off=True)) < 15.0


def test_keeping_off_changes_nothing_where_nothing_is_pressed():
    free, kept = (replanned(*controller(seed=2), 2, replace(REACH, keeps_off=off))[-1] for off in (False, True))
    assert np.array_equal(free.update.knots, kept.update.knots)


def test_a_stiffer_stage_begins_with_the_force_of_the_softer_one_before():
    """A hand that presses softly, its target 4 cm ahead, would strike with four times the force."""
    planner, now = controller()
    planner.plan(now, REACH, 0)
    ahead = np.array([0.04, 0.0, 0.0])
    turned = multiply(now.tool.quaternion, from_rotvec([0.0, 0.0, 0.2]))
    soft = replace(planner._target, position=now.tool.position + ahead, quaternion=turned, stiffness=150.0)

    def begun(stiffness):
        plan = planner.plan(now, replace(REACH, stiffness_n_m=stiffness), 1, None, soft, 1)
        return plan.update.sampled[0, 0, :3] - now.tool.position, angle_between(planner._centre, now.tool.quaternion)

    for stiffness, share in ((150.0, 1.0), (600.0, 0.25), (100.0, 1.0)):
        lead, angle = begun(stiffness)
        assert lead == pytest.approx(share * ahead, abs=1e-9)
        assert angle == pytest.approx(share * 0.2)
