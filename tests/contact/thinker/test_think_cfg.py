import dataclasses

import pytest

from coral.advisor.consult import BudgetCfg
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.plan.contact_regions import RegionCfg
from coral.contact.thinker.think_cfg import DESK_S, MODEL_S, ThinkCfg, decision_budget, resolved

WIDE = ControllerCfg(workspace_high_m=(0.8, 0.8, 0.6))


def test_regions_may_lie_where_the_controller_lets_the_hand_go():
    region = resolved(ThinkCfg(), WIDE, "heuristic").region
    assert (region.reach_low_m, region.reach_high_m) == (WIDE.workspace_low_m, (0.8, 0.8, 0.6))


def test_bounds_that_were_set_for_regions_stay_though_they_are_the_defaults_of_a_controller():
    set_high = ControllerCfg().workspace_high_m
    region = resolved(ThinkCfg(region=RegionCfg(reach_high_m=set_high)), WIDE, "heuristic").region
    assert (region.reach_low_m, region.reach_high_m) == (WIDE.workspace_low_m, set_high)


@pytest.mark.parametrize(
    ("advisor", "unset_s"), [("heuristic", MODEL_S), ("desk", DESK_S), ("fallible:0.1:desk", DESK_S)]
)
def test_a_deadline_that_was_set_stays_though_it_is_that_of_a_model(advisor, unset_s):
    assert decision_budget(BudgetCfg(), advisor).deadline_s == unset_s
    assert decision_budget(BudgetCfg(max_requeries=1), advisor).deadline_s == unset_s
    assert decision_budget(BudgetCfg(deadline_s=MODEL_S), advisor).deadline_s == MODEL_S


def test_what_was_resolved_is_resolved():
    once = resolved(ThinkCfg(), WIDE, "desk")
    assert resolved(once, ControllerCfg(), "heuristic") == once
    assert None not in dataclasses.astuple(once.region) + dataclasses.astuple(once.budget)
