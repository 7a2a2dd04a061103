from dataclasses import replace

import numpy as np
import pytest

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.plan import imagined_run
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, make_strategy
from coral.contact.plan.imagined_run import imagine, stage_beginnings
from coral.mppi.knots import KnotMppiCfg

UP = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35)"
BAD = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35) / (0.26 - min(self.ee_pos[2], 0.26))"
FEW = replace(ControllerCfg(horizon=20), mppi=KnotMppiCfg(samples=8, fine=0.0, spread_quantile=0.9))


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
