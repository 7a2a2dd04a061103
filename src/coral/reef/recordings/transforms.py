"""Rigid transforms as messages carry them, a translation and a quaternion (x, y, z, w); tracks of them, and between."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Pose

Transform = NDArray[np.float64]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w: the order of ROS messages. Elsewhere in this package w comes first."""
NEAR_S = 0.1
"""A picture without a pose within this time of it is left out (s)."""
GAP_S = 0.5
"""Between poses farther apart than this nothing is interpolated (s)."""
ONE_CLOCK = "one clock that never goes back; cut the bag there (`mcap filter`, `ros2 bag convert`, `rosbag filter`)"
_SAME_S = 1e-6


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


class ClockBackError(ValueError):
    """A time stamp that is older than the one before it by more than `NEAR_S`."""


@dataclass
class StampedTransforms:
    """Transforms in order of time."""

    times: list[float] = field(default_factory=list)
    transforms: list[Transform] = field(default_factory=list)
    gap_s: float = GAP_S

    @property
    def span(self) -> tuple[float, float]:
        """First and last time (s); there is one."""
        return self.times[0], self.times[-1]

    def add(self, t: float, transform: Transform) -> None:
        """Add a transform, which may be up to `NEAR_S` older than the last one.

        Raises:
            ClockBackError: It is older than that: the clock has been set back.
        """
        if self.times and t < self.times[-1] - NEAR_S:
            raise ClockBackError(f"a time stamp of {t:.3f} s after one of {self.times[-1]:.3f} s")
        at = bisect.bisect_right(self.times, t)
        self.times.insert(at, t)
        self.transforms.insert(at, transform)

    def at(self, t: float) -> Transform | None:
        """Return the transform at a time: that of this very stamp, or between two, or one near by; None without."""
        if not self.times:
            return None
        after = bisect.bisect_left(self.times, t - _SAME_S)
        if after < len(self.times) and abs(self.times[after] - t) <= _SAME_S:
            return self.transforms[after]
        if 0 < after < len(self.times):
            before = after - 1
            gap = self.times[after] - self.times[before]
            if gap <= self.gap_s:
                share = (t - self.times[before]) / gap
                return interpolate_transform(self.transforms[before], self.transforms[after], share)
        k = self.nearest(t)
        return self.transforms[k] if abs(self.times[k] - t) <= NEAR_S else None

    def nearest(self, t: float) -> int:
        """Return the index of the transform nearest in time."""
        k = bisect.bisect_left(self.times, t)
        if k == 0 or (k < len(self.times) and self.times[k] - t < t - self.times[k - 1]):
            return k
        return k - 1
