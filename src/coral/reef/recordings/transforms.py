"""Rigid transforms as messages carry them: a translation and a quaternion (x, y, z, w)."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Pose

Quaternion = tuple[float, float, float, float]
"""x, y, z, w: the order of ROS messages. Elsewhere in this package w comes first."""


def quaternion_of(rotation: NDArray[np.float64]) -> Quaternion:
    """Return a rotation matrix as a quaternion (x, y, z, w), w not negative. Shape=(3, 3)."""
    found = np.empty(4)
    mujoco.mju_mat2Quat(found, np.ravel(rotation))
    w, x, y, z = (found if found[0] >= 0.0 else -found).tolist()
    return x, y, z, w


def rotation_of(q: Quaternion) -> NDArray[np.float64]:
    """Return the rotation matrix of a quaternion (x, y, z, w), which need not be of unit length. Shape=(3, 3).

    Raises:
        ValueError: It has no length.
    """
    length = math.sqrt(sum(part * part for part in q))
    if not 1e-6 < length < math.inf:
        raise ValueError("a quaternion without length")
    x, y, z, w = (part / length for part in q)
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, np.array([w, x, y, z]))
    return rotation.reshape(3, 3)


def transform_from(translation: tuple[float, float, float], q: Quaternion) -> NDArray[np.float64]:
    """Return a homogeneous transform. Shape=(4, 4)."""
    transform = np.eye(4)
    transform[:3, :3] = rotation_of(q)
    transform[:3, 3] = translation
    return transform


def body_transform(pose: Pose, height_m: float, roll: float, pitch: float) -> NDArray[np.float64]:
    """Return T_body^world: Rz(yaw) Ry(pitch) Rx(roll), at a height above the seabed. Shape=(4, 4)."""
    level = CameraCfg(pitch_down_deg=0.0)
    # A level camera looks along the body's x: columns right, down, forward become forward, left, up.
    optical = T_world_camera(pose, level, altitude=height_m, roll=roll, pitch=pitch)
    transform = optical.copy()
    transform[:3, 0], transform[:3, 1], transform[:3, 2] = optical[:3, 2], -optical[:3, 0], -optical[:3, 1]
    return transform


def camera_in_body(camera: CameraCfg) -> NDArray[np.float64]:
    """Return T_camera^body of a camera at the body's origin, tilted down. Shape=(4, 4)."""
    transform = T_world_camera(Pose(0.0, 0.0, 0.0), camera)
    transform[:3, 3] = 0.0
    return transform


def euler_of(rotation: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return roll, pitch, yaw of Rz(yaw) Ry(pitch) Rx(roll) (rad). Shape=(3, 3)."""
    pitch = math.asin(max(-1.0, min(1.0, -float(rotation[2, 0]))))
    roll = math.atan2(float(rotation[2, 1]), float(rotation[2, 2]))
    return roll, pitch, math.atan2(float(rotation[1, 0]), float(rotation[0, 0]))


def interpolate_transform(before: NDArray[np.float64], after: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Return the transform at a share of the way between two: straight, and turning evenly (slerp). Shape=(4, 4)."""
    turned, way, whole = np.empty(4), np.empty(3), np.empty(4)
    mujoco.mju_mat2Quat(turned, before[:3, :3].ravel())
    mujoco.mju_mat2Quat(whole, after[:3, :3].ravel())
    mujoco.mju_subQuat(way, whole, turned)
    mujoco.mju_quatIntegrate(turned, way, share)
    w, x, y, z = turned.tolist()
    place = (1.0 - share) * before[:3, 3] + share * after[:3, 3]
    return transform_from((float(place[0]), float(place[1]), float(place[2])), (x, y, z, w))
