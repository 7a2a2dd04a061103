"""The robot's side of a mission in open water: questions on the side, a command at every tick."""

import dataclasses
import math

import numpy as np
import pytest
from garbage import observations
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from coral.advisor.clock import SimulatedClock
from coral.advisor.consult import BudgetCfg
from coral.advisor.question import Reply
from coral.advisor.rules import RuleAdvisor
from coral.errors import InputError
from coral.reef.decide.answers import WaypointChoice
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.planner import InstructionCfg, PlannerCfg
from coral.reef.drive.controller import DdpMppi, MppiCfg
from coral.reef.drive.pd import PdController
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.sight_layer import SightLayer, SightLayerCfg
from coral.reef.mission.assembly import make_planner
from coral.reef.pilot.guard import GuardCfg
from coral.reef.pilot.pilot import NOTHING_LEFT, Pilot
from coral.reef.pilot.pilot_cfg import PilotCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.sensing import Stamped, VehicleObservation
from coral.reef.vehicle.states import PilotState
from coral.reef.vehicle.tour_kernels import advance
from coral.reef.world.geometry import Frame, Label, Pose

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

    def __init__(self, cfg=None, driver=None, planner=None):
        self.events, self.attempts, self.commands, self.pending = [], [], [], []
        belief = Belief(OccupancyMap((20.0, 20.0), CAMERA))
        planner = make_planner(belief, CostFieldCfg(), lambda outlook: (), planner)
        clock = SimulatedClock(f"fixed:{LATENCY_S:g}", np.random.default_rng(0))
        self.pilot = Pilot(
            belief, planner, driver or PdController(), Ahead(), RuleAdvisor(REEF_RULES), clock,
            self.emit, self.attempts.append, cfg,
        )  # fmt: skip
        self.pose, self.t = START, 0.0

    def spoil(self, seen):
        """Make the observation worse, in tests of the guard."""
        return seen

    def emit(self, event, **fields):
        self.events.append({"t": self.t, "event": event, **fields})

    def told(self, event):
        return [e for e in self.events if e["event"] == event]

    def tick(self):
        v, omega = self.pilot.tick(self.spoil(VehicleObservation.at(self.t, self.pose, (0.0, 0.0, 0.0), BARE)))
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


def test_new_words_of_a_mission_are_taken_over_at_the_next_tick_and_told_once(drive):
    mission = drive(planner=PlannerCfg(instruction=InstructionCfg(text="Find the net.")))
    assert mission.pilot.instruct(" Find the tyre. ", "page")
    assert mission.pilot.planner.cfg.instruction.text == "Find the net."
    mission.until(0.2)
    assert mission.pilot.planner.cfg.instruction.text == "Find the tyre."
    assert [(e["text"], e["by"]) for e in mission.told("instruction")] == [("Find the tyre.", "page")]
    with pytest.raises(InputError, match="some words"):
        mission.pilot.instruct(" ", "page")


def test_a_survey_without_an_instruction_has_none_to_change(drive):
    mission = drive()
    assert not mission.pilot.instruct("Find the tyre.", "page")
    mission.tick()
    assert mission.told("instruction") == []


class Leaves(Ahead):
    """Leaves the rest to the robot."""

    async def answer(self, question, rejections):
        return Reply(value=WaypointChoice(forward_m=4, left_m=0, explore_rest=True), raw="")


class Refused(Ahead):
    """Always answers with the place where it is, which is refused."""

    async def answer(self, question, rejections):
        return Reply(value=WaypointChoice(forward_m=0, left_m=0), raw="")


def test_who_is_left_alone_explores_without_a_question(drive):
    mission = drive()
    mission.pilot.consultation.advisor = Leaves()
    mission.until(45.0)
    sources = [goal["source"] for goal in mission.told("goal")]
    assert len(mission.told("question")) == sources.count("advisor") == 1
    assert sources.count("tour") >= 2
    assert all(goal["centroids"] == [] for goal in mission.told("goal") if goal["source"] == "tour")
    assert len(mission.attempts) == 1


def test_a_fallback_stands_in_for_one_answer_and_does_not_leave_the_rest(drive):
    mission = drive(cfg=PilotCfg(fallback="rules", budget=BudgetCfg(max_requeries=0)))
    asks = mission.pilot.consultation
    asks.advisor, asks.fallback = Refused(), Leaves()
    mission.until(45.0)
    sources = [goal["source"] for goal in mission.told("goal")]
    assert sources.count("fallback") >= 2
    assert "tour" not in sources


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
    mission = drive(cfg=PilotCfg(guard=GuardCfg(jump_m=3.0)))
    mission.tick()
    mission.pose = mission.pose._replace(y=mission.pose.y + 2.0)
    mission.tick()
    (left,) = mission.told("monitor")
    assert left["deviation_m"] == pytest.approx(2.0, abs=0.1)
    x, y = mission.pilot.monitor.path[0]
    assert math.dist((x, y), mission.pose[:2]) < 0.2


@pytest.mark.parametrize("sure", [False, True])
def test_who_is_fenced_in_by_doubt_looks_round_and_goes_on_instead_of_ending(drive, sure):
    mission = drive()
    cells = mission.pilot.belief.map
    wall = np.zeros(cells.obstacle.shape, np.bool_)
    wall[:, 280:282] = True
    cells.sight = SightLayer(wall.copy(), cells.cfg.cell_m, cells.camera, 2.3, SightLayerCfg())
    cells.sight._sure[:] = sure
    cells.obstacle |= wall
    cells.explored[:, :300] = True
    mission.spoil = lambda seen: dataclasses.replace(
        seen, frame=Stamped(seen.t, dataclasses.replace(BARE, doubt=np.full(SHAPE, 0.45, np.float32)))
    )
    while not mission.pilot.end_reason and mission.t < 60.0 and len(mission.told("doubt")) < 2:
        mission.tick()
    steps = [e["look"] for e in mission.told("doubt")]
    assert (steps, mission.pilot.end_reason) == (([], NOTHING_LEFT) if sure else (["turn", "forget"], ""))
    if not sure:
        forgot = mission.t
        mission.until(forgot + 8.0)
        assert mission.told("question")[-1]["t"] >= forgot


def test_how_far_eyes_that_doubt_see_is_told_and_told_again_when_the_water_changes(drive):
    mission = drive()
    depth = ground_depth(CAMERA)
    labels = np.where(np.isfinite(depth), np.uint8(Label.SEABED), np.uint8(Label.WATER))

    def murky(seen):
        doubt = np.where(depth < (6.0 if seen.t < 15.0 else 2.5), np.float32(0.001), np.float32(0.3))
        floor = dataclasses.replace(BARE, labels=labels, depth=depth, doubt=doubt)
        return dataclasses.replace(seen, frame=Stamped(seen.t, floor))

    mission.until(12.0)
    assert not mission.told("sight")  # exact pictures have no doubt
    spoilt(mission, murky, 12.0).until(30.0)
    first, second = mission.told("sight")
    assert first["t"] == pytest.approx(12.0)
    assert first["reach_m"] > 3.0 > second["reach_m"] > 1.5


def spoilt(mission, change, start, end=math.inf):
    """Let `change` spoil what the pilot sees from `start` to `end` (s)."""
    mission.spoil = lambda seen: change(seen) if start - 1e-9 <= seen.t < end - 1e-9 else seen
    return mission


def nan_velocity(seen):
    return dataclasses.replace(seen, velocity=Stamped(seen.t, (0.3, math.nan, math.nan)))


def nan_pose(seen):
    return dataclasses.replace(seen, pose=Stamped(seen.t, Pose(math.nan, math.nan, math.nan)))


def no_frame(seen):
    return dataclasses.replace(seen, frame=None)


def blind(seen):
    nothing = dataclasses.replace(BARE, depth=np.full(SHAPE, np.inf, np.float32), labels=np.zeros(SHAPE, np.uint8))
    return dataclasses.replace(seen, frame=Stamped(seen.t, nothing))


def too_large(seen):
    large = Frame(
        np.full((480, 640), 5.0, np.float32), np.full((480, 640), 3, np.uint8), np.zeros((480, 640), np.int32)
    )
    return dataclasses.replace(seen, frame=Stamped(seen.t, large))


def silence(seen):
    return VehicleObservation(t=seen.t)


@pytest.mark.parametrize("change", [nan_velocity, nan_pose, no_frame, blind, too_large, silence])
def test_lost_sensors_stop_the_vehicle_within_a_second_and_it_goes_on_when_they_are_back(drive, change):
    mission = spoilt(drive(), change, 2.0, 6.0).until(9.0)
    moving = {round(0.1 * k, 1): v > 0.0 for k, (v, _) in enumerate(mission.commands)}
    assert all(moving[t / 10] for t in range(20))
    assert not any(moving[t / 10] for t in range(26, 60))
    assert all(moving[t / 10] for t in range(72, 90))
    assert [(e["was"], e["state"]) for e in mission.told("state")] == [
        ("ready", "surveying"), ("surveying", "holding"), ("holding", "surveying"),
    ]  # fmt: skip


def test_one_wrong_measurement_neither_stops_the_vehicle_nor_spoils_what_follows(drive):
    for change in (nan_velocity, nan_pose, no_frame, blind, too_large, silence):
        mission = spoilt(drive(), change, 2.0, 2.1).until(4.0)
        assert np.isfinite(mission.commands).all()
        assert all(v > 0.0 for v, _ in mission.commands)
        assert len(mission.told("state")) == 1


def test_the_reason_of_a_hold_is_told(drive):
    mission = spoilt(drive(), blind, 2.0).until(4.0)
    (refusal,) = mission.told("sensor")
    assert (refusal["t"], refusal["input"], refusal["refused"]) == (2.0, "camera", "blind")
    held = mission.told("state")[-1]
    assert held["reason"] == "camera blind (0.0% of the pixels have a return), for 0.4 s"


def test_a_camera_that_sees_nothing_at_first_does_not_end_the_mission(drive):
    mission = spoilt(drive(), blind, 0.0, 5.0).until(8.0)
    assert mission.pilot.end_reason == ""
    assert set(mission.commands[:50]) == {(0.0, 0.0)}
    assert mission.commands[-1][0] > 0.0
    assert mission.told("goal")[0]["t"] == 5.0


def test_a_vehicle_without_sensors_surfaces_after_a_while(drive):
    mission = spoilt(drive(cfg=PilotCfg(guard=GuardCfg(surface_after_s=3.0))), blind, 2.0).until(10.0)
    states = mission.pilot.safety.states
    assert states.state is PilotState.SURFACING
    assert states.reason.startswith("held for 3 s: camera blind")


def test_an_answer_that_comes_while_the_vehicle_is_held_counts(drive):
    mission = spoilt(drive(), blind, 2.0, 6.0).until(6.5)
    asked = mission.told("question")[0]["t"]
    answered = next(goal["t"] for goal in mission.told("goal") if goal["source"] == "advisor")
    assert 2.5 < asked + LATENCY_S == pytest.approx(answered)


def test_nothing_is_mapped_while_the_pose_is_lost(drive):
    mission = spoilt(drive(), nan_pose, 2.0).until(2.7)
    before = mission.pilot.belief.map.explored.sum()
    mission.until(4.0)
    assert mission.pilot.belief.map.explored.sum() == before


def test_the_end_of_the_survey_is_a_state(drive):
    mission = drive().until(1.0)
    mission.pilot.stop("time limit")
    assert mission.told("state")[-1]["state"] == "stopped"
    assert mission.tick() == (0.0, 0.0)


@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(observations(1.0, CAMERA.height, CAMERA.width), max_size=5))
def test_no_garbage_raises_out_of_tick_or_gives_a_command_beyond_the_limits(garbage):
    mission = Drive(driver=DdpMppi(MppiCfg(n_rollouts=60), rng=np.random.default_rng(0))).until(1.0)
    limits = mission.pilot.driver.vehicle
    for seen in garbage:
        v, omega = mission.pilot.tick(seen)
        assert abs(v) <= limits.max_speed_m_s + 1e-9
        assert abs(omega) <= limits.max_yaw_rate_rad_s + 1e-9
        assert np.isfinite(mission.pilot.belief.pose).all()
    mission.pilot.safety.guard.relocate()
    mission.until(3.0)
    assert mission.pilot.safety.driving
    assert np.isfinite(mission.commands).all()
    mission.pilot.clock.close()
