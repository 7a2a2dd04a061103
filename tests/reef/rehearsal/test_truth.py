"""The truth of a simulation for a camera's double."""

import math

import pytest

from autopilot.autopilot import SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.line import AutopilotLine
from coral.reef.rehearsal.truth import TrueState
from coral.reef.world.geometry import Pose


def test_it_follows_the_vehicle_from_its_first_position_on():
    autopilot = SimulatedAutopilot(Body(OpenWater(start=Pose(100.0, 50.0, 2.0))))
    line = AutopilotLine(autopilot)
    truth = TrueState(line, clock=line.clock)

    def newest():
        return [found for found in (truth.read() for _ in range(20)) if found is not None][-1]

    stamp_s, pose = newest()
    assert stamp_s > 0.0
    assert pose == pytest.approx((0.0, 0.0, 2.0), abs=0.02)
    ahead = Pose(100.0 + 5 * math.cos(2.0), 50.0 + 5 * math.sin(2.0), 2.0)
    autopilot.body.mover.vehicle.reset(ahead)
    assert newest()[1] == pytest.approx((5 * math.cos(2.0), 5 * math.sin(2.0), 2.0), abs=0.03)
    truth.close()


def test_before_anything_came_there_is_no_state():
    line = AutopilotLine(SimulatedAutopilot(Body(OpenWater())))
    line.cut = True
    assert TrueState(line, clock=line.clock).read() is None
