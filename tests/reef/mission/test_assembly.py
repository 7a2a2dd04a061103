import dataclasses

import numpy as np
import pytest

from coral.advisor.clock import SimulatedClock
from coral.advisor.rules import RuleAdvisor
from coral.config import merge
from coral.errors import InputError
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.drive.controller import DdpMppi
from coral.reef.drive.delay_aware_driver import DelayAwareDriver
from coral.reef.drive.pd import PdController
from coral.reef.map.belief import Belief
from coral.reef.map.localization import LocalizationCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.mission.assembly import Deciding, decider_of, latency_of, make_robot, planned
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.tour import TourPilot
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState
from coral.reef.world.geometry import Pose

RULES = RuleAdvisor(REEF_RULES)
SLOW = VehicleResponse(surge_delay_s=0.4, margin_m=0.1)


def robot_of(cfg, response=None, **deciding):
    belief, clock = Belief(OccupancyMap((10.0, 10.0), CameraCfg())), SimulatedClock("0", np.random.default_rng(0))
    deciding = Deciding(advisor=RULES, log=lambda attempt: None, **deciding)
    rng = np.random.default_rng(0)
    made = make_robot(
        cfg, deciding, None, Pose(1.0, 1.0, 0.0), belief, clock, rng, lambda event, **_: None, response=response
    )
    clock.close()
    return made


def test_driver_and_localizer_are_those_of_the_configuration():
    drift = LocalizationCfg(drift_xy=0.02)
    robot = robot_of(MissionCfg(driver="pd", localization=drift))
    assert isinstance(robot.driver, PdController)
    assert robot.localizer.cfg == drift


@pytest.mark.parametrize(("driver", "kind"), [("pd", PdController), ("ddp-mppi", DdpMppi)])
def test_every_driver_plans_ahead_for_a_vehicle_that_obeys_late(driver, kind):
    robot = robot_of(MissionCfg(driver=driver), SLOW)
    assert isinstance(robot.driver, DelayAwareDriver)
    assert isinstance(robot.driver.driver, kind)


def test_the_clearance_of_a_slow_vehicle_is_added():
    cfg = MissionCfg()
    margins = [robot_of(cfg, response).driver.driver.cfg.margin_m for response in (SLOW, VehicleResponse())]
    assert margins == pytest.approx([cfg.controller.margin_m + 0.1, cfg.controller.margin_m])


def test_a_drifting_robot_keeps_more_clearance():
    cfg = MissionCfg(localization=LocalizationCfg(drift_xy=0.06))
    assert robot_of(cfg).driver.cfg.margin_m == pytest.approx(cfg.controller.margin_m + 0.06)
    assert robot_of(MissionCfg()).driver.cfg == MissionCfg().controller


def test_a_plan_made_before_the_dive_takes_the_place_of_questions():
    assert isinstance(robot_of(MissionCfg(), commands=np.zeros((3, 2))).pilot, TourPilot)


def test_a_baseline_answers_in_place_of_the_advisor():
    assert decider_of(MissionCfg(), RULES, 0) is RULES
    assert decider_of(MissionCfg(decider="nearest"), RULES, 0).name == "nearest"


@pytest.mark.parametrize("decider", ["nearest", "frontier", "constant", "clairvoyant"])
def test_a_baseline_without_a_rule_for_words_refuses_a_mission_in_words(decider):
    cfg = merge(MissionCfg(), {"decider": decider, "planner": {"instruction": {"text": "Find the net."}}}, "here")
    with pytest.raises(InputError, match=f"{decider}.*no rule for missions in words"):
        decider_of(cfg, RULES, 0)


def test_rules_take_the_papers_time_unless_told_otherwise():
    assert str(latency_of(MissionCfg(), RULES)) == "fixed:10"
    assert str(latency_of(MissionCfg(latency="fixed:3"), RULES)) == "fixed:3"


def test_a_sweep_passes_every_lane_of_its_spacing(pond):
    commands = planned(pond, dataclasses.replace(MissionCfg(), decider="sweep", lane_m=7.0))
    vehicle = VehicleDynamics(VehicleCfg(model="kinematic"), VehicleState(*Pose(2.0, 3.0, 0.0)))
    places = np.concatenate([vehicle.step((v, omega), 0.1) for v, omega in commands])
    for y in (3.5, 10.5):  # two lanes of 7 m in 14 m
        lane = places[np.abs(places[:, 1] - y) < 0.1]
        assert (lane[:, 0].min() < 2.0, lane[:, 0].max() > 12.0) == (True, True)
