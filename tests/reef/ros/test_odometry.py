import math

import numpy as np
import pytest

from coral.reef.ros.odometry import covariance_of, frame_fault, pose_of, velocity_of
from reef.ros.fake_ros import odometry


def test_heading_is_counter_clockwise_from_east():
    pose, z, roll, pitch = pose_of(odometry(yaw_half=(math.sin(math.pi / 4), math.cos(math.pi / 4))))
    assert pose == pytest.approx((1.0, 2.0, math.pi / 2))
    assert (z, roll, pitch) == pytest.approx((-1.5, 0.0, 0.0))


@pytest.mark.parametrize("broken", [{"x": math.nan}, {"yaw_half": (0.0, 0.0)}, {"z": math.inf}])
def test_a_pose_that_is_none_counts_as_none(broken):
    assert pose_of(odometry(**broken)) is None


def test_a_velocity_that_is_not_finite_counts_as_none():
    assert velocity_of(odometry(speed=math.nan)) is None
    assert velocity_of(odometry(speed=0.25)) == (0.25, 0.0, 0.1)


@pytest.mark.parametrize("frame", ["odom_ned", "world_NED", "base-frd"])
def test_frames_of_other_conventions_are_told(frame):
    assert "REP-103" in frame_fault(odometry(frame=frame))


def test_frames_whose_names_merely_hold_the_letters_are_not():
    assert frame_fault(odometry(frame="aligned_odom")) == ""


def test_a_covariance_of_zeros_is_not_told():
    assert covariance_of(odometry()) is None
    np.testing.assert_allclose(covariance_of(odometry(cov=0.04)), np.diag([0.04] * 3))
