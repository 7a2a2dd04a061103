from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import ControlSequences
from coral.contact.cost.context import Context
from coral.contact.plan import imagined_run
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, make_strategy
from coral.contact.plan.imagined_run import (
    ImaginedJudge,
    ImaginedMoment,
    ImaginedOutcome,
    imagine,
    imagined_truths,
    stage_beginnings,
)
from coral.contact.scene.condition import hand_force
from coral.contact.scene.observation import BodyState, Observation
from coral.mppi.knots import KnotMppiCfg

UP = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35)"
BAD = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35) / (0.26 - min(self.ee_pos[2], 0.26))"
FEW = replace(ControllerCfg(horizon=20), mppi=KnotMppiCfg(samples=8, fine=0.0, spread_quantile=0.9))
NAMES = ["reach", "close", "lift"]
PARTS = ("hand", "left", "right", "table")


def rising(one, code=UP, done="self.ee_pos[2] > 0.28"):
    stages = [StageAnswer(name="rise", code=code, done=done), StageAnswer(name="stay", code=UP)]
    return make_strategy("x", PlanAnswer(stages=stages), None, one.world.schema, one.sizes)


def moments(one, *plan):
    return list(imagine(one.world, rising(one, *plan), one.now, 0.8, FEW))


@pytest.fixture
def beginnings(monkeypatch):
    monkeypatch.setattr(imagined_run, "CONTROLLER", FEW)
    monkeypatch.setattr(imagined_run, "MOST_S", 1.2)
    return lambda one, *plan: stage_beginnings(one.world, rising(one, *plan), one.now, ["rise", "stay"])


def test_the_plan_is_followed_from_the_present_state(scene):
    one = scene("pick-box")
    seen = moments(one)
    assert seen[0].now is one.now
    np.testing.assert_allclose(np.diff([moment.now.time_s for moment in seen]), 0.08)
    assert [moment.stage for moment in seen] == sorted(moment.stage for moment in seen)
    (change,) = [moment for moment in seen if moment.stage != moment.next_stage]
    assert (change.stage, change.next_stage) == ("rise", "stay")
    assert seen[-1].now.tool.position[2] > 0.27 > one.now.tool.position[2]


def test_a_cost_that_fails_ends_the_run(scene):
    one = scene("pick-box")
    assert len(moments(one, BAD, "self.ee_pos[2] > 0.34")) < len(moments(one))


def test_each_stage_counts_its_own_time(scene):
    """The second stage ends 0.3 s after it began, whenever that was."""
    one = scene("pick-box")
    stages = [
        StageAnswer(name="rise", code=UP, done="self.ee_pos[2] > self.ee_stage_pos[2] + 0.01"),
        StageAnswer(name="wait", code=UP, done="self.stage_time > 0.3"),
        StageAnswer(name="stay", code=UP),
    ]
    plan = make_strategy("x", PlanAnswer(stages=stages), None, one.world.schema, one.sizes)
    changes = [m.now.time_s for m in imagine(one.world, plan, one.now, 0.8, FEW) if m.stage != m.next_stage]
    assert len(changes) == 2
    assert changes[1] - changes[0] == pytest.approx(0.32)


def test_a_later_stage_begins_where_the_one_before_it_ends(scene, beginnings):
    one = scene("pick-box")
    states = beginnings(one)
    assert states["rise"] is one.now
    assert states["stay"].tool.position[2] > 0.26 > one.now.tool.position[2]
    assert 0.0 < states["stay"].time_s - one.now.time_s < 1.2
    np.testing.assert_array_equal(beginnings(one)["stay"].tool.position, states["stay"].tool.position)


@pytest.mark.parametrize(("code", "done"), [(UP, "self.ee_pos[2] > 9.0"), (BAD, "self.ee_pos[2] > 0.34")])
def test_a_stage_that_is_not_reached_has_no_beginning(scene, beginnings, code, done):
    assert list(beginnings(scene("pick-box"), code, done)) == ["rise"]


def moment(one, time_s, stage, shift=(0.0, 0.0, 0.0), touching=(), newtons=0.0, steps=1, name="box"):
    """A moment whose control steps all have the same state, the object moved by `shift` (m)."""
    tool, held = one.now.tool, one.now.objects[name]
    states = {
        "time": time_s + 0.02 * np.arange(1, steps + 1),
        "gripper_opening": np.full(steps, one.now.opening_m),
        f"{name}_hand_force": np.tile([newtons, 0.0, 0.0], (steps, 1)),
        **{f"{name}_{part}_contact": np.full(steps, part in touching) for part in PARTS},
        **{f"ee_{kind}": np.zeros((steps, 3)) for kind in ("vel", "angvel", "force", "torque")},
        **{f"{name}_{kind}": np.zeros((steps, 3)) for kind in ("vel", "angvel")},
        "ee_pos": np.tile(tool.position, (steps, 1)),
        "ee_quat": np.tile(tool.quaternion, (steps, 1)),
        f"{name}_pos": np.tile(held.position + np.asarray(shift), (steps, 1)),
        f"{name}_quat": np.tile(held.quaternion, (steps, 1)),
    }
    after = Context({key: value[None] for key, value in states.items()}, (1, steps))
    now = Observation(
        time_s, tool, one.now.opening_m, one.now.wrench, {name: BodyState(held.position, held.quaternion)}
    )
    return ImaginedMoment(now, stage, stage, SimpleNamespace(), after)


def judged(one, moments, names=NAMES):
    judge = ImaginedJudge(one.trial, names)
    for each in moments:
        judge.update(each)
    return judge


def test_without_any_moment_nothing_was_reached(scene):
    assert judged(scene("pick-box"), []).outcome == ImaginedOutcome(False, 0.0, 0.0, 0.0)


def test_the_farthest_stage_and_the_time_after_it_count(scene):
    one = scene("pick-box")
    stages = ["reach", "reach", "close", "reach"]
    found = judged(one, [moment(one, 0.1 * k, stage, touching=("table",)) for k, stage in enumerate(stages)])
    outcome = found.outcome
    assert (outcome.succeeded, outcome.stages, outcome.conditions) == (False, pytest.approx(2 / 3), 0.5)
    assert outcome.spare_s == pytest.approx(one.trial.task.time_limit_s - 0.2)
    assert not found.gained  # upright and still held from the beginning


def test_a_box_held_up_long_enough_is_a_success(scene):
    one = scene("pick-box")
    up, held = (0.0, 0.0, 0.12), ("hand", "left", "right")
    outcome = judged(one, [moment(one, 0.1 * k, "lift", up, held) for k in range(10)]).outcome
    assert (outcome.succeeded, outcome.stages) == (True, 1.0)
    assert outcome.spare_s == pytest.approx(one.trial.task.time_limit_s - 0.5, abs=0.1)
    assert not judged(one, [moment(one, 0.1 * k, "lift", up, ("hand", "left")) for k in range(10)]).succeeded


def test_a_condition_that_is_met_later_is_a_gain_even_if_it_is_lost_again(scene):
    one = scene("pick-box")
    held = moment(one, 0.1, "lift", (0.0, 0.0, 0.12), ("hand", "left", "right"))
    assert judged(one, [moment(one, 0.0, "reach"), held, moment(one, 0.2, "lift")]).gained


def test_what_can_never_be_mended_is_named(scene):
    one = scene("push-force")
    carried = [moment(one, 0.1 * k, "reach", (0.0, 0.0, 0.1), ("hand",), name="block") for k in range(5)]
    assert judged(one, carried).broken == ("kept-touching of block",)
    off = (0.0, 0.0, -0.4 - 0.1)
    far = [moment(one, 0.0, "reach", (3.0, 0.0, *off[2:]), ("table",), name="block")]
    assert judged(one, far).broken == ("dropped: block",)


def test_a_blow_counts_but_is_no_evidence_for_good(scene):
    one = scene("push-force")
    calm = judged(one, [moment(one, 0.1 * k, "reach", touching=("table",), name="block") for k in range(3)])
    touching = ("hand", "table")
    blow = judged(one, [moment(one, 0.1 * k, "reach", touching=touching, newtons=60.0, name="block") for k in range(3)])
    assert blow.broken == calm.broken == ()
    assert blow.outcome.conditions == pytest.approx(calm.outcome.conditions - 1 / 6)


def test_a_body_that_coarse_steps_let_through_the_table_breaks_nothing(scene):
    one = scene("push-force")
    assert judged(one, [moment(one, 0.0, "reach", (0, 0, -0.06), ("table",), name="block")]).broken == ()


def test_imagined_contacts_are_those_of_the_planning_world(scene):
    one = scene("pick-box")
    first, last = imagined_truths(one.trial, moment(one, 0.3, "lift", touching=("left", "table"), steps=2))
    assert [(each.first, each.second) for each in last.contacts] == [("box", "left"), ("box", "table")]
    assert (first.time_s, last.time_s) == pytest.approx((0.32, 0.34))
    assert imagined_truths(one.trial, ImaginedMoment(one.now, "lift", "lift", SimpleNamespace())) == []


def test_imagined_forces_are_those_of_the_planning_world(scene):
    """A hand that presses the block down: the judge reads what the simulation feels."""
    one = scene("push-force")
    block = one.now.objects["block"].position
    top = np.array([*block[:2], block[2] + one.sizes["block"][2] / 2])
    over = np.linspace(one.now.tool.position, top + np.array([0, 0, 0.05]), 50)
    path = np.concatenate([over, np.linspace(over[-1], top - [0, 0, 0.02], 50), [top - [0, 0, 0.02]] * 20])[None]
    turn = np.tile(one.now.tool.quaternion, (1, path.shape[1], 1))
    states, _ = one.world.rollout(one.now, ControlSequences(path, turn, np.zeros(path.shape[:2]), 600.0))
    truths = imagined_truths(one.trial, ImaginedMoment(one.now, "x", "x", SimpleNamespace(), states))
    felt = np.linalg.norm(states.block_hand_force[0], axis=-1)
    assert felt.max() > 3.0
    assert hand_force(truths[0], "block") is None
    assert [hand_force(truth, "block") or 0.0 for truth in truths] == pytest.approx(felt)


def test_success_comes_before_stages_stages_before_conditions_and_these_before_time():
    order = [
        ImaginedOutcome(False, 0.3, 0.9, 5.0),
        ImaginedOutcome(False, 0.6, 0.2, 1.0),
        ImaginedOutcome(False, 0.6, 0.4, 0.5),
        ImaginedOutcome(False, 0.6, 0.4, 0.7),
        ImaginedOutcome(True, 1.0, 1.0, 0.1),
    ]
    assert all(worse < better for worse, better in pairwise(order))
