"""The imagined run of a remembered plan."""

import pytest
from recorded import compose

from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, in_process, make_strategy
from coral.contact.thinker.progress_monitor import OuterCfg
from coral.contact.thinker.recall_run import try_recalled

UP = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35)"
STILL = "def state_cost(self):\n    return norm(self.ee_vel)"
SOON = OuterCfg(n_retry=3)


def tried(one, *stages, cfg=SOON, repaired=False):
    plan = PlanAnswer(stages=[StageAnswer(**stage) for stage in stages])
    strategy = make_strategy("x", plan, None, one.world.schema, one.sizes)
    return try_recalled(one.world, one.trial, strategy, plan.names, one.now, cfg, repaired)


def test_a_good_plan_succeeds_and_its_run_ends_then(scene):
    one = scene("pick-box")
    made = compose(one.facts)
    strategy = make_strategy("x", made.plan, made.regions, one.world.schema, one.sizes, in_process)
    found = try_recalled(one.world, one.trial, strategy, made.plan.names, one.now, OuterCfg())
    assert (found.outcome.succeeded, found.refusal) == (True, "")
    assert found.outcome.spare_s == pytest.approx(one.trial.task.time_limit_s - found.length_s, abs=0.2)


def test_a_plan_that_never_leaves_its_first_stage_is_refused_once_it_is_stuck(scene):
    one = scene("pick-box")
    found = tried(one, {"name": "wait", "code": STILL, "done": "self.ee_pos[2] < 0"}, {"name": "rise", "code": UP})
    assert found.refusal == "in an imagined run, it never left its first stage, 'wait'"
    assert found.length_s < 2.0 < one.trial.task.time_limit_s


def test_a_plan_that_was_repaired_then_may_be_stuck_now(scene):
    one = scene("pick-box")
    stages = {"name": "wait", "code": STILL, "done": "self.ee_pos[2] < 0"}, {"name": "rise", "code": UP}
    assert tried(one, *stages, repaired=True).refusal == ""


def test_a_plan_of_one_stage_that_gains_nothing_is_refused(scene):
    assert "met no condition" in tried(scene("pick-box"), {"name": "all", "code": UP}).refusal


def test_coming_to_the_last_stage_is_enough_for_others(scene):
    """What is believed to be too heavy is not lifted in imagination."""
    one = scene("pick-box")
    found = tried(one, {"name": "rise", "code": UP, "done": "self.ee_pos[2] > 0.28"}, {"name": "stay", "code": UP})
    assert (found.outcome.stages, found.refusal) == (1.0, "")


def test_one_that_is_stuck_between_is_not_refused_for_that(scene):
    one = scene("pick-box")
    rise = {"name": "rise", "code": UP, "done": "self.ee_pos[2] > 0.28"}
    stay = {"name": "stay", "code": UP, "done": "self.ee_pos[2] < 0"}
    found = tried(one, rise, stay, {"name": "never", "code": UP})
    assert (found.outcome.stages, found.refusal) == (pytest.approx(2 / 3), "")


def test_one_that_falls_back_twice_is_refused(scene):
    one = scene("pick-box")
    rise = {"name": "rise", "code": UP, "done": "self.time > 0"}
    stay = {"name": "stay", "code": UP, "done": "self.ee_pos[2] < 0", "lost": "self.time > 0", "back_to": "rise"}
    found = tried(one, rise, stay, {"name": "never", "code": UP})
    assert found.refusal == "in an imagined run, it fell back to an earlier stage 2 times"


def test_one_that_breaks_something_for_good_is_refused(scene, monkeypatch):
    one = scene("push-force")
    monkeypatch.setattr(
        "coral.contact.plan.imagined_outcome.ImaginedJudge._broken", lambda *_: ("kept-level of block",)
    )
    assert (
        tried(one, {"name": "all", "code": UP}).refusal == "in an imagined run, it breaks for good: kept-level of block"
    )
