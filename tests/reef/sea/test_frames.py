"""Frames: by hand for the four headings, and there and back again."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from autopilot.autopilot import pose_to_ned, velocity_to_ned
from coral.reef.sea.frames import LocalFrame, pose_from_ned, tilt_from_frd, velocity_from_ned
from coral.reef.world.geometry import Pose, to_world, wrap

angles = st.floats(-3.1, 3.1)
metres = st.floats(-100, 100)
POSES = st.builds(Pose, st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 3))


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


@given(POSES, POSES)
def test_the_reported_pose_becomes_the_start(reported, start):
    frame = LocalFrame.from_start(reported, start, trust_heading=False)
    found = frame.to_survey(reported)
    assert found[:2] == pytest.approx(start[:2], abs=1e-9)
    assert math.cos(found.theta - start.theta) == pytest.approx(1.0)


@given(POSES, POSES)
def test_what_lies_ahead_in_one_frame_lies_ahead_in_the_other(reported, start):
    frame = LocalFrame.from_start(reported, start, trust_heading=False)
    ahead = Pose(*to_world(reported, 2.0, 0.5), reported.theta)
    assert frame.to_survey(ahead)[:2] == pytest.approx(to_world(start, 2.0, 0.5), abs=1e-9)


def test_a_compass_heading_is_kept():
    frame = LocalFrame.from_start(Pose(100.0, 50.0, 1.0), Pose(2.0, 3.0, 0.0), trust_heading=True)
    assert frame.to_survey(Pose(101.0, 50.0, 1.0)) == pytest.approx((3.0, 3.0, 1.0))
