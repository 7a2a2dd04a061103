"""The robot's side of a mission in open water: questions on the side, a command at every tick."""

import dataclasses
import math

import numpy as np
import pytest

from coral.advisor.clock import SimulatedClock
from coral.advisor.question import Reply
from coral.advisor.rules import RuleAdvisor
from coral.reef.answers import WaypointChoice
from coral.reef.belief import Belief
from coral.reef.camera import CameraCfg
from coral.reef.costfield import CostFieldCfg
from coral.reef.geometry import Frame, Label, Pose
from coral.reef.heuristic import REEF_RULES
from coral.reef.mapping import OccupancyMap
from coral.reef.pd import PdController
from coral.reef.pilot import Pilot, PilotCfg
from coral.reef.planner import HighLevelPlanner
from coral.reef.tour_kernels import advance

CAMERA = CameraCfg()
SHAPE = (CAMERA.height, CAMERA.width)
BARE = Frame(
    depth=np.full(SHAPE, 5.0, np.float32),
    labels=np.full(SHAPE, Label.SEABED, np.uint8),
    instances=np.full(SHAPE, -1, np.int32),
)
"""Bare seabed, 5 m of it in sight."""
START = Pose(6.0, 10.0, 0.0)
LATENCY_S = 3.0


class Ahead:
    """Always answers: four metres ahead."""

    name = "ahead"

    async def answer(self, question, rejections):
        return Reply(value=WaypointChoice(forward_m=4, left_m=0), raw="")


class Drive:
    """A pilot in a vehicle that moves as it is told."""

    def __init__(self, cfg=None, driver=None):
        self.events, self.attempts, self.commands, self.pending = [], [], [], []
        belief = Belief(OccupancyMap((20.0, 20.0), CAMERA))
        planner = HighLevelPlanner(belief, CostFieldCfg(), lambda kind, context: (kind, "0"), lambda belief: ())
        clock = SimulatedClock(f"fixed:{LATENCY_S:g}", np.random.default_rng(0))
        self.pilot = Pilot(
            belief, planner, driver or PdController(), Ahead(), RuleAdvisor(REEF_RULES), clock,
            self.emit, self.attempts.append, cfg,
        )  # fmt: skip
        self.pose, self.t = START, 0.0

    def emit(self, event, **fields):
        self.events.append({"t": self.t, "event": event, **fields})

    def told(self, event):
        return [e for e in self.events if e["event"] == event]

    def tick(self):
        v, omega = self.pilot.tick(self.t, BARE, self.pose, (0.0, 0.0, 0.0))
        self.commands.append((v, omega))
        self.pending.append(self.pilot.pending)
        self.pose, self.t = Pose(*advance(*self.pose, v, omega, 0.1)), round(self.t + 0.1, 9)
        return v, omega

    def until(self, t):
        while self.t < t:
            self.tick()
        return self


@pytest.fixture
def drive():
    made = []

    def go(**keys):
        made.append(Drive(**keys))
        return made[-1]

    yield go
    for each in made:
        each.pilot.clock.close()


def test_the_first_goal_lies_straight_ahead_of_the_start(drive):
    mission = drive()
    v, _ = mission.tick()
    (goal,) = mission.told("goal")
    assert goal["source"] == "initial"
    assert goal["x"] > START.x + 1.0
    assert goal["y"] == pytest.approx(START.y)
    assert v > 0.0


def test_the_robot_drives_on_while_a_question_is_open_and_hears_the_answer_when_it_is_due(drive):
    mission = drive().until(LATENCY_S + 2.0)
    asked = mission.told("question")[0]["t"]
    answered = next(goal["t"] for goal in mission.told("goal") if goal["source"] == "advisor")
    assert answered == pytest.approx(asked + LATENCY_S)
    assert [attempt.verdict for attempt in mission.attempts][:1] == ["accepted"]
    assert all(v > 0.0 for v, _ in mission.commands[: round(answered / 0.1)])


def test_a_synchronous_robot_stands_still_while_a_question_is_open(drive):
    mission = drive(cfg=PilotCfg(synchronous=True)).until(LATENCY_S + 2.0)
    moving = {False: [], True: []}
    for (v, omega), waits in zip(mission.commands, mission.pending, strict=True):
        moving[waits].append((v, omega) != (0.0, 0.0))
    assert len(moving[True]) >= round(LATENCY_S / 0.1)
    assert not any(moving[True])
    assert any(moving[False])


class Stuck(PdController):
    """Finds no way."""

    def plan(self, *args, **keys):
        return dataclasses.replace(super().plan(*args, **keys), command=(0.0, 0.0), ok=False, failure="no way")


def test_a_planner_that_finds_no_way_is_noted_at_every_tick(drive):
    mission = drive(driver=Stuck()).until(1.0)
    assert [e["reason"] for e in mission.told("planner_failure")] == ["no way"] * 10
    assert set(mission.commands) == {(0.0, 0.0)}


def test_who_is_pushed_off_its_path_plans_it_anew_from_there(drive):
    mission = drive()
    mission.tick()
    mission.pose = mission.pose._replace(y=mission.pose.y + 2.0)
    mission.tick()
    (left,) = mission.told("monitor")
    assert left["deviation_m"] == pytest.approx(2.0, abs=0.1)
    x, y = mission.pilot.monitor.path[0]
    assert math.dist((x, y), mission.pose[:2]) < 0.2
