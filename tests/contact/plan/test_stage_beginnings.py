from dataclasses import replace

import numpy as np
import pytest

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, make_strategy
from coral.contact.plan.imagined_run import ImaginedRunCfg, stage_beginnings
from coral.mppi.knots import KnotMppiCfg

UP = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35)"
BAD = "def state_cost(self):\n    return abs(self.ee_pos[2] - 0.35) / (0.3 - min(self.ee_pos[2], 0.3))"
CFG = ImaginedRunCfg(
    most_s=1.2,
    controller=replace(ControllerCfg(horizon=20), mppi=KnotMppiCfg(samples=8, fine=0.0, spread_quantile=0.9)),
)


def strategy(one, code=UP, done="self.ee_pos[2] > 0.28"):
    stages = [StageAnswer(name="rise", code=code, done=done), StageAnswer(name="stay", code=UP)]
    return make_strategy("x", PlanAnswer(stages=stages), None, one.world.schema, one.sizes)


def found(one, plan):
    return stage_beginnings(one.world, plan, one.now, ["rise", "stay"], CFG)


def test_a_later_stage_begins_where_the_one_before_it_ends(scene):
    one = scene("pick-box")
    states = found(one, strategy(one))
    assert states["rise"] is one.now
    assert states["stay"].tool.position[2] > 0.26 > one.now.tool.position[2]
    assert 0.0 < states["stay"].time_s - one.now.time_s < 1.2
    again = found(one, strategy(one))
    np.testing.assert_array_equal(again["stay"].tool.position, states["stay"].tool.position)


@pytest.mark.parametrize(("code", "done"), [(UP, "self.ee_pos[2] > 9.0"), (BAD, "self.ee_pos[2] > 0.34")])
def test_a_stage_that_is_not_reached_has_no_beginning(scene, code, done):
    one = scene("pick-box")
    assert list(found(one, strategy(one, code, done))) == ["rise"]
