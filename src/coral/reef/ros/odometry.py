"""nav_msgs/Odometry as the pilot's loop needs it: planar pose, velocity, attitude and covariance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.reef.recordings.frame_tree import points_down
from coral.reef.recordings.transforms import euler_of, rotation_of
from coral.reef.world.geometry import Pose

PLANAR = (0, 1, 5)
"""Rows of x, y and yaw in a covariance of six."""


def frame_fault(message: Any) -> str:
    """Return why an odometry's frames are not east-north-up and forward-left-up, or ""."""
    for frame in (str(message.header.frame_id), str(message.child_frame_id)):
        if points_down(frame):
            return f"odometry in {frame!r}: x east, y north, z up is needed (REP-103)"
    return ""


def pose_of(message: Any) -> tuple[Pose, float, float, float] | None:
    """Return the planar pose, z (m, up), roll and pitch (rad) of an odometry; None if it has no finite ones."""
    at, q = message.pose.pose.position, message.pose.pose.orientation
    values = (at.x, at.y, at.z, q.x, q.y, q.z, q.w)
    length = math.sqrt(q.x**2 + q.y**2 + q.z**2 + q.w**2)
    if not all(map(math.isfinite, values)) or not 0.9 < length < 1.1:
        return None
    roll, pitch, yaw = euler_of(rotation_of((q.x, q.y, q.z, q.w)))
    return Pose(at.x, at.y, yaw), at.z, roll, pitch


def velocity_of(message: Any) -> tuple[float, float, float] | None:
    """Return m/s forward, m/s to the left and rad/s to the left; None if they are not finite."""
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    found = (float(linear.x), float(linear.y), float(angular.z))
    return found if all(map(math.isfinite, found)) else None


def covariance_of(message: Any) -> NDArray[np.float64] | None:
    """Return the covariance of x, y (m) and yaw (rad); None if it is unknown: all zero, or -1. Shape=(3, 3)."""
    full = np.asarray(message.pose.covariance, float).reshape(6, 6)
    planar = full[np.ix_(PLANAR, PLANAR)]
    told = bool(np.isfinite(planar).all() and planar[0, 0] > 0.0 and planar[1, 1] > 0.0)
    return planar if told else None
