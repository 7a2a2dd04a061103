"""Transforms as messages carry them, and at any time."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.reef.recordings.transforms import (
    StampedTransforms,
    body_transform,
    camera_in_body,
    euler_of,
    quaternion_of,
    rotation_of,
    transform_from,
)
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Pose

angles = st.floats(-math.pi, math.pi)


@given(roll=angles, pitch=st.floats(-1.5, 1.5), yaw=angles)
def test_a_quaternion_is_the_same_rotation(roll, pitch, yaw):
    rotation = body_transform(Pose(0, 0, yaw), 1.0, roll, pitch)[:3, :3]
    np.testing.assert_allclose(rotation_of(quaternion_of(rotation)), rotation, atol=1e-12)
    again = body_transform(Pose(0, 0, euler_of(rotation)[2]), 1.0, *euler_of(rotation)[:2])[:3, :3]
    np.testing.assert_allclose(again, rotation, atol=1e-9)


def test_a_quarter_turn_about_z_has_x_y_z_w_in_this_order():
    assert quaternion_of(body_transform(Pose(0, 0, math.pi / 2), 1.0, 0.0, 0.0)[:3, :3]) == pytest.approx(
        (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
    )


def test_body_and_mount_together_are_the_camera():
    camera, pose = CameraCfg(pitch_down_deg=20.0), Pose(1.0, 2.0, 0.7)
    ours = body_transform(pose, 1.3, 0.1, -0.2) @ camera_in_body(camera)
    np.testing.assert_allclose(ours, T_world_camera(pose, camera, altitude=1.3, roll=0.1, pitch=-0.2), atol=1e-12)


def test_a_quaternion_without_length_is_refused():
    with pytest.raises(ValueError, match="length"):
        transform_from((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))


def track(*stamped):
    made = StampedTransforms()
    for t, x, yaw in stamped:
        made.add(t, body_transform(Pose(x, 0.0, yaw), 1.0, 0.0, 0.0))
    return made


def test_between_two_poses_the_way_is_straight_and_the_turn_even():
    made = track((1.0, 0.0, math.radians(170)), (1.2, 1.0, math.radians(-170))).at(1.15)
    assert made[0, 3] == pytest.approx(0.75)
    assert math.degrees(euler_of(made[:3, :3])[2]) == pytest.approx(-175)


def test_a_pose_of_the_same_stamp_is_taken_to_the_last_bit():
    stamped = track((1.0, 0.3, 0.2), (1.2, 1.0, 0.4))
    assert stamped.at(1.2) is stamped.transforms[1]


def test_far_from_all_poses_there_is_none():
    stamped = track((1.0, 0.0, 0.0), (3.0, 1.0, 0.0))
    assert stamped.at(2.0) is None
    assert stamped.at(3.05)[0, 3] == 1.0
    assert stamped.at(3.2) is None
    assert StampedTransforms().at(1.0) is None


def test_messages_a_little_out_of_order_are_sorted_and_a_clock_set_back_is_told():
    stamped = track((1.0, 0.0, 0.0), (1.1, 2.0, 0.0), (1.05, 1.0, 0.0))
    assert [one[0, 3] for one in stamped.transforms] == [0.0, 1.0, 2.0]
    with pytest.raises(ValueError, match=r"0\.500 s after one of 1\.100 s"):
        stamped.add(0.5, np.eye(4))
