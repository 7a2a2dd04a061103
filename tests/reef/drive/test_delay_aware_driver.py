"""A controller that plans for a vehicle which obeys late, brakes slowly, or both."""

import cv2
import numpy as np
import pytest
from given_fields import field_to

from coral.reef.drive.controller import DdpMppi
from coral.reef.drive.delay_aware_driver import DelayAwareDriver
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.response import Trailing, VehicleResponse
from coral.reef.vehicle.vehicle import VehicleState

CELL = 0.05
SLOW = VehicleResponse(surge_lag_s=0.3, yaw_lag_s=0.3, surge_delay_s=0.4, yaw_delay_s=0.4, trail=0.2, trail_lag_s=4.0)


def posts():
    """Free water of 8 m by 8 m with posts in it, 1.1 m apart."""
    obstacle = np.zeros((160, 160), np.uint8)
    for row, x in enumerate((2.6, 3.7, 4.8, 5.9)):
        for y in np.arange(0.5 + 0.55 * (row % 2), 8.0, 1.3):
            cv2.circle(obstacle, (round(x / CELL), round(y / CELL)), 3, 1, -1)
    return cv2.distanceTransform(1 - obstacle, cv2.DIST_L2, 5) * np.float32(CELL)


def least_clearance(planned_with):
    """Drive a slow vehicle between the posts with a controller; return the least clearance of its hull (m)."""
    distance = posts()
    field = field_to((7.0, 3.0), distance)
    driver = DelayAwareDriver(DdpMppi(rng=np.random.default_rng(0), response=planned_with), planned_with, 0.6)
    state, trailing, least = VehicleState(1.5, 3.0, 0.0), Trailing(), np.inf
    sent = [(0.0, 0.0)] * 4
    for _ in range(250):
        command = driver.plan(state, field, distance).command
        driver.note(command)
        sent.append(command)
        state, trailing = SLOW.advance(state, trailing, sent[-5], 0.1)
        least = min(least, float(distance[int(state.y / CELL), int(state.x / CELL)]) - 0.3)
    return least


def test_a_slow_vehicle_keeps_the_margin_only_if_the_controller_knows_it():
    """The controller's margin is 0.08 m."""
    assert least_clearance(SLOW) > 0.075 > least_clearance(VehicleResponse())


def test_the_plan_begins_where_the_command_will_find_the_vehicle():
    driver = DelayAwareDriver(DdpMppi(rng=np.random.default_rng(0), response=SLOW), SLOW, 0.6)
    for _ in range(40):
        driver.note((0.5, 0.0))
    field = CostField.straight((160, 160), (7.0, 3.0))
    open_water = np.full((160, 160), np.inf, np.float32)
    plan = driver.plan(VehicleState(1.5, 3.0, 0.0, 0.5), field, open_water)
    assert plan.path[0, 0] == pytest.approx(1.5 + 0.4 * 0.5, abs=0.01)
