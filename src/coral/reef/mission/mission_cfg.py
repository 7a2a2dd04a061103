"""The configuration of a mission: everything but the world, the vehicle, the advisor and the seed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from coral.config import Positive, TimeStep
from coral.reef.decide.planner import PlannerCfg
from coral.reef.drive.controller import MppiCfg
from coral.reef.eyes.backends import EXACT
from coral.reef.map.belief import BeliefCfg
from coral.reef.map.localization import LocalizationCfg
from coral.reef.map.mapping import MapCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.pilot.pilot_cfg import PilotCfg
from coral.reef.simulation.simulator import SimulatorCfg


@dataclass(frozen=True, kw_only=True)
class MissionCfg:
    """Everything that defines a mission except the world, the advisor and the seed."""

    time_limit_s: Positive = 600.0
    control_period_s: TimeStep = 0.1
    """10 Hz (paper IV-F)."""
    latency: str = "auto"
    """Reply time of the advisor in simulated seconds: fixed:S, lognormal:MEDIAN:SIGMA or measured. auto: as recorded
    for a recording, measured for models and people, fixed:10 for rules, the paper's median for CORAL (IV-E). In real
    time an answer is given no earlier than this, later if it takes longer; auto is then the time that it takes."""
    stop_when_covered: bool = False
    """End when every true cluster is covered: the experimenter stops the mission, as for the paper's coverage time, and
    tables of coverage do so. The robot does not know it and decides nothing by it; in real water nobody knows it. By
    default the robot continues until nothing is left."""
    perception: str = EXACT
    """Where classes and depth come from: exact, by the simulator's ray caster, which a real camera lacks; painted or
    rgb, from colour pictures, by the networks of the package for painted and for real ones; or your own, FILE.onnx."""
    depth: str = ""
    """File of a relative depth network (Depth Anything V2), whose depth replaces that of `perception`; its scale and
    shift are fitted to the sea floor and the sonar's echoes."""
    driver: str = "ddp-mppi"
    """The low-level planner: ddp-mppi, pd, or an entry point of the group coral.controllers."""
    decider: Literal[
        "advisor", "nearest", "frontier", "constant", "random", "clairvoyant", "lawnmower", "sweep", "oracle",
        "geometry", "keywords"
    ] = "advisor"  # fmt: skip
    """Who answers the questions: the advisor, or a baseline's rules in its place; the clairvoyant knows the true
    clusters. lawnmower, sweep and oracle ask no questions: they follow lanes around obstacles, lanes through whatever
    is in the way, or a tour planned on the true reef. geometry and keywords, for missions in words: rules that know
    the conditions but not the kinds, or read key words."""
    lane_m: Positive = 4.0
    """Distance between the lanes of lawnmower and sweep (m): the swath in which oysters can be counted is 4.6 m."""
    simulator: SimulatorCfg = field(default_factory=SimulatorCfg)
    localization: LocalizationCfg = field(default_factory=LocalizationCfg)
    map: MapCfg = field(default_factory=MapCfg)
    belief: BeliefCfg = field(default_factory=BeliefCfg)
    planner: PlannerCfg = field(default_factory=PlannerCfg)
    pilot: PilotCfg = field(default_factory=PilotCfg)
    controller: MppiCfg = field(default_factory=MppiCfg)
    record: RecordCfg = field(default_factory=RecordCfg)
