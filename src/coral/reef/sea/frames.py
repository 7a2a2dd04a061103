"""Frames: of the autopilot (north-east-down, forward-right-down) to ours (ENU, FLU; REP-103), and the survey's own."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Pose, to_world, wrap


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


@dataclass(frozen=True)
class LocalFrame:
    """A shift and a turn from the vehicle's frame to the survey's, both ENU.

    A vehicle's position begins somewhere: at its EKF's origin, or where its DVL was last reset. The operator puts it at
    the survey's start, and what it reports there is the start from then on.
    """

    x: float = 0.0
    y: float = 0.0
    turn: float = 0.0

    @classmethod
    def from_start(cls, reported: Pose, start: Pose, *, trust_heading: bool) -> LocalFrame:
        """Make the frame in which a pose, reported in the vehicle's own frame, is the survey's start.

        `trust_heading`: the reported heading is that of a compass, counted from east as the survey's is, and only the
        position is shifted. Otherwise the vehicle is taken to head as the start says.
        """
        turn = 0.0 if trust_heading else wrap(start.theta - reported.theta)
        x, y = to_world(Pose(0.0, 0.0, turn), reported.x, reported.y)
        return cls(start.x - x, start.y - y, turn)

    def to_survey(self, pose: Pose) -> Pose:
        """Convert a pose of the vehicle's frame to the survey's."""
        x, y = to_world(Pose(self.x, self.y, self.turn), pose.x, pose.y)
        return Pose(x, y, wrap(pose.theta + self.turn))

    def turned(self, covariance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert the covariance of a pose: x, y (m), theta (rad). Shape=(3, 3)."""
        c, s = math.cos(self.turn), math.sin(self.turn)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return np.asarray(turn @ covariance @ turn.T)
