"""The truth of a simulation for a camera's double."""

import math

import pytest

from autopilot.autopilot import SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.line import AutopilotLine
from coral.reef.rehearsal.truth import TruthFeed
from coral.reef.world.geometry import Pose


def test_it_follows_the_vehicle_from_its_first_position_on():
    autopilot = SimulatedAutopilot(Body(OpenWater(start=Pose(100.0, 50.0, 2.0))))
    line = AutopilotLine(autopilot)
    feed = TruthFeed(line, clock=line.clock)
    for _ in range(20):
        feed.poll()
    assert feed.state.pose == pytest.approx((0.0, 0.0, 2.0), abs=0.02)
    ahead = Pose(100.0 + 5 * math.cos(2.0), 50.0 + 5 * math.sin(2.0), 2.0)
    autopilot.body.mover.vehicle.reset(ahead)
    autopilot.body.depth_m = 1.5
    for _ in range(20):
        feed.poll()
    assert feed.state.pose == pytest.approx((5 * math.cos(2.0), 5 * math.sin(2.0), 2.0), abs=0.03)
    assert feed.state.depth_m == pytest.approx(1.5, abs=0.1)
    assert feed.state.stamp_s > 0.0
    feed.close()


def test_before_anything_came_there_is_no_state():
    line = AutopilotLine(SimulatedAutopilot(Body(OpenWater())))
    line.cut = True
    feed = TruthFeed(line, clock=line.clock)
    feed.poll()
    assert feed.state is None
