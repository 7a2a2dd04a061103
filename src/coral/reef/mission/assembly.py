"""A robot from its configuration: the same at sea as in the simulator."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.consult import Attempt
from coral.advisor.latency import LatencyCfg, latency_for, parse_latency
from coral.advisor.question import Advisor
from coral.advisor.rules import RuleAdvisor
from coral.errors import InputError
from coral.reef.decide.baselines import baseline_rules
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.mission_planner import MissionPlanner
from coral.reef.decide.own_parts import Verifier, Wanted
from coral.reef.decide.paper_planner import PaperPlanner
from coral.reef.decide.planner import Draw, HighLevelPlanner, PlannerCfg
from coral.reef.decide.tour_planner import TourPlanner
from coral.reef.decide.wordless import BlindOrders, Wordless
from coral.reef.drive.controllers import ControllerSetup, MakeController, controller_maker
from coral.reef.drive.delay_aware_driver import DelayAwareDriver
from coral.reef.eyes.perception import RgbPerception
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.localization import Localizer
from coral.reef.mission.bound import oracle_bound
from coral.reef.mission.clairvoyant import clairvoyant
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.robot import Robot
from coral.reef.mission.tour import LanesPilot, TourPilot, along, drive_lines, lanes
from coral.reef.mission.word_oracle import word_tour
from coral.reef.pilot.pilot import Pilot
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.vehicle.sensing import Vehicle
from coral.reef.world.geometry import Pose
from coral.reef.world.world import ReefWorld

PAPER_LATENCY = "fixed:10"
"""Median latency of a call in the paper's CORAL experiments (IV-E)."""
WITHOUT_WORDS = ("nearest", "frontier", "constant", "clairvoyant")
"""Deciders that answer no question of a mission in words."""
UNSEEN_S = 1.0
"""Time for which an obstacle is out of the picture while the robot passes it: the position that it loses meanwhile is
added to the clearance."""


@dataclass(frozen=True, kw_only=True)
class Deciding:
    """Who decides for a mission's robot, and what replaces our own parts."""

    advisor: Advisor
    log: Callable[[Attempt], None]
    draw: Draw = lambda outlook: ()
    """Draws the pictures of a question."""
    make_driver: MakeController | None = None
    """None: `driver` of the configuration."""
    wanted: Wanted | None = None
    """Decides when the advisor is asked; None: Eq. 12."""
    verify: Verifier | None = None
    commands: NDArray[np.float64] | None = None
    """A plan to follow in place of questions. Shape=(K, 2)."""


def make_robot(
    cfg: MissionCfg,
    deciding: Deciding,
    vehicle: Vehicle,
    start: Pose,
    belief: Belief,
    clock: SimulatedClock | WallClock,
    rng: np.random.Generator,
    emit: Callable[..., None],
    *,
    eyes: RgbPerception | None = None,
    response: VehicleResponse | None = None,
) -> Robot:
    """Make a robot.

    `eyes` are applied to the vehicle's pictures in the loop, None if they have classes and depth when they arrive.
    `response` is how the vehicle follows its set-points, None: at once, as the simulated one does. The clearance that
    it needs is added to the controller's.
    """
    vehicle_cfg = cfg.simulator.vehicle
    make_driver = deciding.make_driver or controller_maker(cfg.driver)
    inert_m = 0.0 if response is None else response.margin_m
    margin_m = cfg.controller.margin_m + inert_m + cfg.localization.drift_xy * math.sqrt(UNSEEN_S)
    setup = ControllerSetup(
        cfg=replace(cfg.controller, margin_m=margin_m),
        vehicle=vehicle_cfg,
        rng=rng,
        control_period_s=cfg.control_period_s,
        response=response,
    )
    driver = make_driver(setup)
    if response is not None:
        driver = DelayAwareDriver(driver, response, vehicle_cfg.max_speed_m_s, cfg.control_period_s)

    lawnmower = LanesPilot if cfg.decider == "lawnmower" else Pilot
    pilot = (lawnmower if deciding.commands is None else TourPilot)(
        belief,
        make_planner(belief, cfg.pilot.fields, deciding.draw, cfg.planner),
        driver,
        deciding.advisor,
        RuleAdvisor(REEF_RULES),
        clock,
        emit,
        deciding.log,
        cfg.pilot,
        deciding.wanted,
        deciding.verify,
    )
    if isinstance(pilot, TourPilot) and deciding.commands is not None:
        pilot.commands = deciding.commands
    if isinstance(pilot, LanesPilot):
        pilot.points = along(lanes(belief.map.size_m, cfg.lane_m, start))
        if cfg.planner.instruction.text:
            pilot.points.append(start[:2])  # missions in words may end there
    return Robot(vehicle, start, pilot, Localizer(cfg.simulator.camera, cfg.localization), eyes=eyes)


def make_planner(belief: Belief, fields: CostFieldCfg, draw: Draw, cfg: PlannerCfg | None = None) -> HighLevelPlanner:
    """Make the planner of one robot: that of missions in words where there is one, else the configured one."""
    cfg = cfg or PlannerCfg()
    kind = MissionPlanner if cfg.instruction.text else PaperPlanner if cfg.algorithm == "paper" else TourPlanner
    return kind(belief, fields, draw, cfg)


def decider_of(cfg: MissionCfg, advisor: Advisor, seed: int, world: ReefWorld | None = None) -> Advisor:
    """Return who answers the questions: the advisor, or a baseline in its place, as configured.

    Raises:
        InputError: The baseline needs what is not there, or has no rule for a mission in words.
    """
    if cfg.decider == "advisor":
        return advisor
    if cfg.planner.instruction.text and cfg.decider in WITHOUT_WORDS:
        raise InputError("--variant", "", cfg.decider, "another one: it has no rule for missions in words")
    if cfg.decider == "clairvoyant":
        if world is None:
            raise InputError("--cfg.decider", "", "clairvoyant", "another one: nobody knows the truth here")
        return clairvoyant(world)
    if cfg.decider in ("geometry", "keywords"):
        orders = BlindOrders.of_words(cfg.planner.instruction.text)
        if cfg.decider == "geometry" and world is not None and world.mission is not None:
            kinds = {thing.name: thing.kind for thing in world.things}
            orders = BlindOrders.of_conditions(world.mission.conditions, kinds)
        return RuleAdvisor({**REEF_RULES, "reef-mission": Wordless(orders)}, name=cfg.decider)
    return RuleAdvisor(baseline_rules(cfg.decider, np.random.default_rng([seed, 11])), name=cfg.decider)


def planned(world: ReefWorld, cfg: MissionCfg) -> NDArray[np.float64] | None:
    """Plan the commands of the oracle's tour or of a blind sweep, Shape=(K, 2); None where questions are asked."""
    if cfg.decider not in ("oracle", "sweep"):
        return None
    sim, start = cfg.simulator, Pose(world.start.x, world.start.y, world.start.theta)
    if cfg.decider == "sweep":
        return drive_lines(lanes(world.size_m, cfg.lane_m, start), start, sim.vehicle, cfg.control_period_s)
    if world.mission is not None:
        return word_tour(world, sim.vehicle, cfg.control_period_s)
    visibility_m = sim.noise.visibility_m
    return oracle_bound(world, sim.camera, sim.imaging, visibility_m, sim.vehicle, cfg.control_period_s).commands


def latency_of(cfg: MissionCfg, advisor: Advisor) -> LatencyCfg:
    """Return the latency that simulated time gives an advisor: as configured, or that of the paper for rules."""
    latency = latency_for(advisor, cfg.latency)
    return parse_latency(PAPER_LATENCY) if cfg.latency == "auto" and latency == parse_latency("0") else latency


def latency_in_real_time(cfg: MissionCfg, advisor: Advisor) -> LatencyCfg:
    """Return how late answers are given in real time: as configured; auto is the time that the advisor takes."""
    return LatencyCfg(kind="measured") if cfg.latency == "auto" else latency_for(advisor, cfg.latency)
