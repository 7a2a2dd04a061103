"""Transforms as messages carry them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.reef.recordings.transforms import (
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
