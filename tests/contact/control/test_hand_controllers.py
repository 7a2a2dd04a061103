import dataclasses

import pytest

from coral.contact.control.hand_controllers import PlannerLimits, hand_controller_maker
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.reactive import ReactiveCfg
from coral.errors import InputError
from coral.mppi.knots import KnotMppiCfg


def test_ours_is_made_by_name_and_a_function_is_taken_as_it_is():
    assert hand_controller_maker("mppi") is Controller
    assert hand_controller_maker(Controller) is Controller


@pytest.mark.parametrize(("controller", "said"), [("mpi", "did you mean 'mppi'"), (3, "found 3")])
def test_what_is_no_controller_is_refused(controller, said):
    with pytest.raises(InputError, match=said):
        hand_controller_maker(controller)


def test_the_limits_are_those_of_the_configuration():
    cfg = ControllerCfg(horizon=30, speed_m_s=0.3, mppi=KnotMppiCfg(samples=64), workspace_low_m=(-0.2, -0.3, 0.0))
    limits = PlannerLimits(cfg, 0.04, 0.12, 0.1)
    assert (limits.horizon_s, limits.replan_s, limits.late_s) == pytest.approx((1.2, 0.12, 0.1))
    assert limits.press_n == ReactiveCfg().force_limit_n
    assert limits.free_n == cfg.press_free_n
    assert PlannerLimits(dataclasses.replace(cfg, press_weight=0.0), 0.04, 0.12).free_n is None
