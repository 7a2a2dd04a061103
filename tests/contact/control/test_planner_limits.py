import dataclasses

import pytest

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planner_limits import PlannerLimits
from coral.contact.control.reactive import ReactiveCfg
from coral.mppi.knots import KnotMppiCfg


def test_the_limits_are_those_of_the_configuration():
    cfg = ControllerCfg(horizon=30, speed_m_s=0.3, mppi=KnotMppiCfg(samples=64), workspace_low_m=(-0.2, -0.3, 0.0))
    limits = PlannerLimits(cfg, 0.04, 0.12, 0.1)
    assert (limits.horizon_s, limits.replan_s, limits.late_s) == pytest.approx((1.2, 0.12, 0.1))
    assert limits.press_n == ReactiveCfg().force_limit_n
    assert limits.free_n == cfg.press_free_n
    assert PlannerLimits(dataclasses.replace(cfg, press_weight=0.0), 0.04, 0.12).free_n is None
