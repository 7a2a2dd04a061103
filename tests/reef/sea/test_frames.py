"""Frames: by hand for the four headings, and there and back again."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from autopilot.autopilot import pose_to_ned, velocity_to_ned
from coral.reef.sea.frames import pose_from_ned, tilt_from_frd, velocity_from_ned
from coral.reef.world.geometry import Pose, wrap

angles = st.floats(-3.1, 3.1)
metres = st.floats(-100, 100)


@pytest.mark.parametrize(("yaw_deg", "theta_deg"), [(0, 90), (90, 0), (180, -90), (-90, 180)])
def test_headings_from_north_clockwise_become_angles_from_east(yaw_deg, theta_deg):
    pose = pose_from_ned(3.0, 4.0, math.radians(yaw_deg))
    assert (pose.x, pose.y) == (4.0, 3.0)
    assert wrap(pose.theta - math.radians(theta_deg)) == pytest.approx(0.0, abs=1e-12)


def test_a_vehicle_heading_east_that_moves_north_moves_to_its_left():
    assert velocity_from_ned(0.5, 0.2, math.pi / 2, 0.1) == pytest.approx((0.2, 0.5, -0.1))


def test_nose_up_is_negative_pitch_and_left_side_up_positive_roll():
    assert tilt_from_frd(0.1, 0.2) == (0.1, -0.2)


@given(x=metres, y=metres, theta=angles, velocity=st.tuples(metres, metres, angles))
def test_there_and_back(x, y, theta, velocity):
    north, east, yaw = pose_to_ned(Pose(x, y, theta))
    back = pose_from_ned(north, east, yaw)
    assert (back.x, back.y) == (x, y)
    assert wrap(back.theta - theta) == pytest.approx(0.0, abs=1e-9)
    assert velocity_from_ned(*velocity_to_ned(velocity, yaw)[:2], yaw, -velocity[2]) == pytest.approx(
        velocity, abs=1e-9
    )
