"""From the autopilot's frames to ours and back: north-east-down and forward-right-down, to ENU and FLU (REP-103)."""

from __future__ import annotations

import math

from coral.reef.world.geometry import Pose, wrap


def pose_from_ned(north_m: float, east_m: float, yaw_rad: float) -> Pose:
    """Convert a position and a heading (clockwise from north) to ENU: x east, y north, counter-clockwise from east."""
    return Pose(east_m, north_m, wrap(math.pi / 2 - yaw_rad))


def velocity_from_ned(
    north_m_s: float, east_m_s: float, yaw_rad: float, yaw_rate_rad_s: float
) -> tuple[float, float, float]:
    """Convert a velocity over ground to the level body frame FLU: m/s forward, m/s to the left, rad/s to the left."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return c * north_m_s + s * east_m_s, s * north_m_s - c * east_m_s, -yaw_rate_rad_s


def tilt_from_frd(roll_rad: float, pitch_rad: float) -> tuple[float, float]:
    """Convert roll and pitch: roll keeps its sign, pitch is positive nose down in FLU and nose up in FRD."""
    return roll_rad, -pitch_rad
