"""The PD controller: straight at the goal, whatever is in the way."""

import math

import numpy as np
import pytest

from coral.reef.drive import pd
from coral.reef.drive.pd import PdController
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.vehicle import VehicleDynamics, VehicleState


def plan(state, goal):
    return PdController().plan(VehicleState(*state), CostField.straight((240, 240), goal))


def test_it_drives_straight_and_through():
    goal, solid = (9.0, 6.0), np.zeros((240, 240), np.float32)
    field, vehicle, trace = CostField.straight((240, 240), goal), VehicleDynamics(state=VehicleState(3.0, 6.0, 0.5)), []
    controller = PdController()
    for _ in range(200):
        command = controller.plan(vehicle.state, field, solid).command
        trace.extend(vehicle.step(command).tolist())
    assert math.dist(vehicle.state[:2], goal) < 0.35
    assert max(abs(y - 6.0) for _, y in trace) < 0.8


def test_the_law_near_the_goal_by_hand():
    # 0.4 m ahead, 0.2 rad to the left: below both limits.
    goal = (5.0 + 0.4 * math.cos(0.2), 5.0 + 0.4 * math.sin(0.2))
    surge, yaw = pd.SURGE_KP_N_M / pd.SURGE_KD_NS_M, pd.YAW_KP_NM_RAD / pd.YAW_KD_NMS_RAD
    assert plan((5.0, 5.0, 0.0), goal).command == pytest.approx((surge * 0.4 * math.cos(0.2), yaw * 0.2))


def test_a_goal_behind_is_turned_to_and_not_reversed_to():
    assert plan((6.0, 6.0, 0.0), (3.0, 6.0)).command == (0.0, 0.6)
    assert plan((6.0, 6.0, 0.0), (3.0, 5.9)).command == (0.0, -0.6)


def test_at_the_goal_it_holds():
    found = plan((6.0, 6.0, 1.0), (6.1, 6.2))
    assert found.command == (0.0, 0.0)
    np.testing.assert_allclose(found.path[:, :2], np.tile((6.0, 6.0), (11, 1)))


def test_the_shown_path_is_the_line_to_the_goal_and_ends_there():
    found = plan((1.0, 2.0, 0.0), (2.5, 2.0))
    assert found.path.shape == (11, 3)
    np.testing.assert_allclose(found.path[:, 1], 2.0)
    assert found.path[0, 0] == 1.0
    assert found.path[-1, 0] == pytest.approx(2.5)
    assert (np.diff(found.path[:, 0]) >= 0.0).all()


def test_a_state_that_is_not_finite_fails():
    failed = plan((5.0, math.nan, 0.0), (9.0, 6.0))
    assert (failed.ok, failed.command) == (False, (0.0, 0.0))
