from coral.contact.control.controller import ControllerCfg
from coral.contact.plan.contact_regions import RegionCfg
from coral.contact.thinker.think_cfg import ThinkCfg, within

WIDE = ControllerCfg(workspace_high_m=(0.8, 0.8, 0.6))


def test_regions_may_lie_where_the_controller_lets_the_hand_go():
    assert within(WIDE, ThinkCfg()).region.reach_high_m == (0.8, 0.8, 0.6)
    assert within(ControllerCfg(), ThinkCfg()) == ThinkCfg()


def test_bounds_that_were_set_for_regions_stay():
    own = ThinkCfg(region=RegionCfg(reach_high_m=(0.2, 0.2, 0.2)))
    assert within(WIDE, own) == own
