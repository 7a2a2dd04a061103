"""Rigid transforms as messages carry them: a translation and a quaternion (x, y, z, w)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Pose

Quaternion = tuple[float, float, float, float]
"""x, y, z, w: the order of ROS messages. Elsewhere in this package w comes first."""


def quaternion_of(rotation: NDArray[np.float64]) -> Quaternion:
    """Return a rotation matrix as a quaternion (x, y, z, w), w not negative. Shape=(3, 3)."""
    m = rotation
    squares = np.array([1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2],
                        1 - m[0, 0] - m[1, 1] + m[2, 2], 1 + m[0, 0] + m[1, 1] + m[2, 2]])  # fmt: skip
    k = int(np.argmax(squares))
    s = math.sqrt(float(squares[k])) * 2.0
    if k == 3:
        q = ((m[2, 1] - m[1, 2]) / s, (m[0, 2] - m[2, 0]) / s, (m[1, 0] - m[0, 1]) / s, s / 4)
    elif k == 0:
        q = (s / 4, (m[0, 1] + m[1, 0]) / s, (m[0, 2] + m[2, 0]) / s, (m[2, 1] - m[1, 2]) / s)
    elif k == 1:
        q = ((m[0, 1] + m[1, 0]) / s, s / 4, (m[1, 2] + m[2, 1]) / s, (m[0, 2] - m[2, 0]) / s)
    else:
        q = ((m[0, 2] + m[2, 0]) / s, (m[1, 2] + m[2, 1]) / s, s / 4, (m[1, 0] - m[0, 1]) / s)
    sign = -1.0 if q[3] < 0.0 else 1.0
    x, y, z, w = (sign * float(part) for part in q)
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
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


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
    one, other = (np.array(quaternion_of(transform[:3, :3])) for transform in (before, after))
    cosine = float(np.dot(one, other))
    if cosine < 0.0:
        other, cosine = -other, -cosine
    angle = math.acos(min(cosine, 1.0))
    if angle < 1e-6:
        mixed = (1.0 - share) * one + share * other
    else:
        mixed = (math.sin((1.0 - share) * angle) * one + math.sin(share * angle) * other) / math.sin(angle)
    x, y, z, w = (float(part) for part in mixed)
    place = (1.0 - share) * before[:3, 3] + share * after[:3, 3]
    return transform_from((float(place[0]), float(place[1]), float(place[2])), (x, y, z, w))
