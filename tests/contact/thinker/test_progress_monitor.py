"""What the outer loop remembers of surprises; what counts as progress is in test_thinker.py."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.scene.observation import BodyState, HandTarget, Observation, Transition
from coral.contact.thinker import progress_monitor
from coral.contact.thinker.progress_monitor import FORCE_STEPS, SURPRISE_TAU_S, OuterCfg, ProgressMonitor, note_of
from coral.contact.thinker.strategist import PlanReport

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def observed(time_s, x_m):
    """The box at a place, the hand still."""
    at_rest = BodyState(np.zeros(3), UPRIGHT)
    return Observation(time_s, at_rest, 0.08, np.zeros(6), {"box": BodyState(np.array([x_m, 0.0, 0.0]), UPRIGHT)})


def surprise_after(seconds, period_s):
    """What is left of one surprise of 5 cm when nothing surprises any more for so long, at a period between plans."""
    monitor, before = ProgressMonitor(OuterCfg(), ("push",)), observed(0.0, 0.0)
    still = HandTarget(np.zeros(3), UPRIGHT, 0.08, 600.0)
    for k in range(round(seconds / period_s) + 2):
        now = observed(k * period_s, 0.05 if k else 0.0)
        now_at = {"box_pos": now.objects["box"].position[None, None]}
        plan = SimpleNamespace(cost=1.0, terms={}, now=now_at, expected_force=np.zeros((10, 3)), at_edge=0.0)
        taken = (Transition(before, still, now),) if k else ()
        monitor.update(PlanReport(now, plan, "push", taken, next_state=plan.now))
        before = now
    return monitor.surprise_m["box"]


@pytest.mark.parametrize("period_s", [0.02, 0.04, 0.1])
def test_a_surprise_fades_in_seconds_whatever_the_period_between_plans(period_s):
    assert surprise_after(1.0, period_s) == pytest.approx(0.05 * math.exp(-1.0 / SURPRISE_TAU_S), rel=1e-6)


def test_at_the_default_period_a_surprise_loses_four_percent_with_each_plan():
    assert surprise_after(0.04, 0.04) == pytest.approx(0.05 * 0.96, rel=1e-14)


def noticed_after(costs):
    """The time (s) at which the outer loop steps in; costs are (stage, cost) of the plans, one in 0.04 s, repeated."""
    monitor = ProgressMonitor(OuterCfg(), ("reach", "close", "lift"))
    for k in range(1000):
        stage, cost = costs[k % len(costs)]
        plan = SimpleNamespace(cost=cost, terms={}, expected_force=np.full((10, 3), 2.0), at_edge=0.0)
        if monitor.update(PlanReport(observed(0.04 * k, 0.0), plan, stage, ())):
            assert monitor.notes[-1].expected_force == (2.0, 2.0, 2.0)
            return 0.04 * k
    return None


def test_a_grasp_that_slips_again_and_again_is_no_progress_although_its_costs_fall_each_time():
    falling = [(stage, 3.0 - 0.1 * k) for stage in ("reach", "close", "lift") for k in range(20)]
    assert 2.0 < noticed_after(falling) < 9.0


def test_a_reward_without_bound_that_creeps_is_no_progress_for_ever():
    fast = [("reach", -2.0 - 0.3 * k) for k in range(40)]
    creeping = [("reach", fast[-1][1] - 0.001 * k) for k in range(960)]
    assert noticed_after(fast + creeping) == pytest.approx(0.04 * 40 + 15 * 0.2, abs=0.3)


def test_the_first_values_of_a_stages_end_are_kept_longer_than_the_record(monkeypatch):
    monkeypatch.setattr(progress_monitor, "HISTORY_S", 0.1)
    read = iter(range(100))
    end = SimpleNamespace(read=lambda present: (next(read),))
    monitor = ProgressMonitor(OuterCfg(), ("reach", "lift"), {"reach": end})
    plan = SimpleNamespace(cost=1.0, terms={}, now={}, expected_force=np.zeros((10, 3)), at_edge=0.0)
    for k in range(10):
        monitor.update(PlanReport(observed(0.04 * k, 0.0), plan, "reach", (), present="measured"))
    monitor.update(PlanReport(observed(0.4, 0.0), plan, "lift", (), present="measured"))
    assert monitor.first_ends == {"reach": (0,)}
    assert [note.end for note in monitor.notes] == [(8,), (9,), ()]


def test_a_note_keeps_what_a_diagnosis_reads_and_averages_the_first_predicted_forces():
    force = np.zeros((2 * FORCE_STEPS, 3))
    force[:FORCE_STEPS, 2] = np.linspace(0.0, 4.0, FORCE_STEPS)
    plan = SimpleNamespace(terms={"way": 3.0}, expected_force=force, at_edge=0.5)
    touched, sunk_m = {"left": ("box",)}, {"box": 0.01}
    note = note_of(PlanReport(SimpleNamespace(time_s=0.3), plan, "reach", touched=touched, sunk_m=sunk_m))
    assert (note.time_s, note.stage, note.terms, note.touched) == (0.3, "reach", {"way": 3.0}, touched)
    assert note.end == ()
    assert (note.expected_force, note.sunk_m, note.at_edge) == ((0.0, 0.0, 2.0), sunk_m, 0.5)


def test_a_note_keeps_how_the_end_of_the_stage_stands_in_the_measured_state():
    plan = SimpleNamespace(terms={}, expected_force=np.zeros((2, 3)), at_edge=0.0)
    end = SimpleNamespace(read=lambda present: (present,))
    report = PlanReport(SimpleNamespace(time_s=0.3), plan, "reach", present="measured")
    assert note_of(report, end).end == ("measured",)
    assert note_of(report).end == note_of(replace(report, present=None), end).end == ()
