"""A vehicle with its sensors and its pilot, in a small pool with one post."""

import dataclasses

import numpy as np
import pytest
from given_eyes import FlatEyes

from coral.advisor.clock import SimulatedClock
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.tour_planner import TourPlanner
from coral.reef.drive.pd import PdController
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.localization import Localizer
from coral.reef.map.mapping import OccupancyMap
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.mission.robot import Robot
from coral.reef.pilot.pilot import Pilot
from coral.reef.simulation.simulator import ReefSimulator, SimulatedVehicle, SimulatorCfg
from coral.reef.vehicle.sensing import Attitude, Stamped
from coral.reef.world.geometry import Pose
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

POOL = ReefWorld(
    name="pool",
    size_m=(10.0, 10.0),
    start=Start(x=3.0, y=5.0),
    clusters=(Cluster(name="a", oysters=(Oyster(x=8.0, y=8.0, z=0.05, radii=(0.1, 0.1, 0.05)),)),),
    obstacles=(Obstacle(shape="cylinder", x=4.0, y=5.0, z=0.8, size=(0.2, 0.2, 0.8)),),
)


@pytest.fixture
def robot():
    """Makes robots whose events are kept in `events`."""
    clocks = []

    def make(eyes=None, **simulator):
        cfg = SimulatorCfg(**simulator)
        clocks.append(SimulatedClock("fixed:3", np.random.default_rng(0)))
        events = []

        def emit(event, **fields):
            events.append({"event": event, **fields})

        world = ReefSimulator(POOL, cfg, np.random.default_rng(0))
        belief, rules = Belief(OccupancyMap(POOL.size_m, cfg.camera, None, cfg.sonar)), RuleAdvisor(REEF_RULES)
        planner = TourPlanner(belief, CostFieldCfg(), lambda outlook: ())
        pilot = Pilot(belief, planner, PdController(), rules, rules, clocks[-1], emit, lambda attempt: None)
        made = Robot(SimulatedVehicle(world, 0.1, emit), world.pose, pilot, Localizer(cfg.camera), eyes=eyes)
        made.events = events
        return made

    yield make
    for clock in clocks:
        clock.close()


def test_it_senses_decides_and_drives(robot):
    one = robot()
    assert one.vehicle.simulator.pose[:2] == (3.0, 5.0)
    for k in range(10):
        one.sense(0.1 * k)
        one.localize(0.1 if k else 0.0)
        assert one.think() >= 0.0
        one.act()
    assert one.command[0] > 0.0
    x, y, _ = one.vehicle.simulator.pose
    assert x > 3.1
    assert y == pytest.approx(5.0, abs=0.05)


def test_a_covariance_and_an_old_velocity_reach_guard_and_localizer(robot, monkeypatch):
    one = robot()
    observe = one.vehicle.observe

    def doubtful(t):
        seen = observe(t)
        old = dataclasses.replace(seen.velocity, t=t - 0.2)
        return dataclasses.replace(seen, covariance=np.diag([1e-4, 1e-4, 1e-5]) * (1.0 + t), velocity=old)

    monkeypatch.setattr(one.vehicle, "observe", doubtful)
    for k in range(20):
        one.sense(0.1 * k)
        one.localize(0.1 if k else 0.0)
        one.command = (0.3, 0.0)
        one.act()
    assert one.seen.covariance[0, 0] == pytest.approx(2.9e-4)
    assert one.localizer.active
    assert one.localizer.sigma[0] > 0.0
    assert one.seen.velocity.t == pytest.approx(0.1 * 17)


def test_a_corrected_pose_takes_what_is_around_the_robot_along(robot, monkeypatch):
    one, told = robot(), []
    corrected = Pose(3.5, 5.2, 0.1)
    monkeypatch.setattr(one.localizer, "update", lambda *_: corrected)
    monkeypatch.setattr(one.belief, "correct", lambda before, after, *, found: told.append((before, after, found)))
    one.sense(0.0)
    one.localize(0.0)
    assert told == [(one.reading.frame_pose, corrected, False)]


def test_landmarks_are_measured_as_far_as_the_eyes_see(robot, monkeypatch):
    one, told = robot(), []
    monkeypatch.setattr(one.localizer, "update", lambda *given: told.append(given[-1]) or Pose(3.0, 5.0, 0.0))
    monkeypatch.setattr(type(one.belief.map), "sees_m", 1.5)
    one.sense(0.0)
    one.localize(0.0)
    assert told == [1.5]


def test_a_picture_is_kept_with_the_height_that_was_measured(robot):
    one = robot()
    one.sense(0.0)
    attitude = Attitude(roll=0.1, pitch=-0.2, depth_m=3.0, altitude_m=1.3)
    one.seen = dataclasses.replace(one.seen, attitude=Stamped(0.0, attitude))
    one.localize(0.0)
    assert (one.taken_at.height_m, one.taken_at.roll, one.taken_at.pitch) == (1.3, 0.1, -0.2)


def test_eyes_are_told_what_the_sonar_hears_in_the_picture(robot):
    eyes = FlatEyes()
    listening = robot(pictures=True, sonar=SonarCfg(enabled=True), eyes=eyes)
    listening.sense(0.0)
    assert eyes.attitude.echoes.shape[1] == 3
    assert len(eyes.attitude.echoes) > 1000
    listening.sense(0.1)  # the next image is due after 0.2 s
    assert eyes.attitude.echoes is None
