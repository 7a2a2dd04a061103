"""From the autopilot's frames to ours and back: north-east-down and forward-right-down, to ENU and FLU (REP-103)."""

from __future__ import annotations

import math

from coral.reef.world.geometry import Pose, wrap


def pose_from_ned(north_m: float, east_m: float, yaw_rad: float) -> Pose:
    """Convert a position and a heading (clockwise from north) to ENU: x east, y north, counter-clockwise from east."""
    return Pose(east_m, north_m, wrap(math.pi / 2 - yaw_rad))


def pose_to_ned(pose: Pose) -> tuple[float, float, float]:
    """Convert an ENU pose to (north m, east m, yaw rad): the inverse of `pose_from_ned`."""
    return pose.y, pose.x, wrap(math.pi / 2 - pose.theta)


def velocity_from_ned(
    north_m_s: float, east_m_s: float, yaw_rad: float, yaw_rate_rad_s: float
) -> tuple[float, float, float]:
    """Convert a velocity over ground to the level body frame FLU: m/s forward, m/s to the left, rad/s to the left."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return c * north_m_s + s * east_m_s, s * north_m_s - c * east_m_s, -yaw_rate_rad_s


def velocity_to_ned(velocity: tuple[float, float, float], yaw_rad: float) -> tuple[float, float, float]:
    """Convert a velocity in FLU to (m/s north, m/s east, rad/s clockwise): the inverse of `velocity_from_ned`."""
    forward, left, turn = velocity
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return c * forward + s * left, s * forward - c * left, -turn


def tilt_from_frd(roll_rad: float, pitch_rad: float) -> tuple[float, float]:
    """Convert roll and pitch: roll keeps its sign, pitch is positive nose down in FLU and nose up in FRD."""
    return roll_rad, -pitch_rad
