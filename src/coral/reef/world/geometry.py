"""Poses and frames of the reef: world ENU, body FLU (REP-103), camera optical (REP-103)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Pose(NamedTuple):
    """Planar pose in the world frame (m, m, rad)."""

    x: float
    y: float
    theta: float


class Label(IntEnum):
    """Class of a camera pixel."""

    WATER = 0
    OYSTER = 1
    OBSTACLE = 2
    SEABED = 3


@dataclass(frozen=True)
class Frame:
    """One camera picture."""

    depth: NDArray[np.float32]
    """Depth along the optical axis, not range (m); inf where nothing is seen. Shape=(H, W), float32."""
    labels: NDArray[np.uint8]
    """`Label` of every pixel: 0 water, 1 oyster, 2 obstacle, 3 seabed. Shape=(H, W), uint8."""
    instances: NDArray[np.int32]
    """Index of the object in the scene, -1 for seabed and water. Shape=(H, W), int32. For tests and metrics
    only: no decision reads it."""
    rgb: NDArray[np.uint8] | None = None
    """The colour picture, sRGB; None where none was taken. Shape=(H, W, 3), uint8."""
    doubt: NDArray[np.float32] | None = None
    """Probability that the label of a pixel is wrong; None where labels are exact. Shape=(H, W), float32."""
    still: Callable[[], NDArray[np.uint8]] | None = None
    """Takes the colour picture in full size, Shape=(H, W, 3), when it is wanted; None where there is none."""

    @classmethod
    def of_colours(cls, rgb: NDArray[np.uint8]) -> Frame:
        """Return a picture of which only the colours are known."""
        size = rgb.shape[:2]
        return cls(np.full(size, np.inf, np.float32), np.zeros(size, np.uint8), np.full(size, -1, np.int32), rgb)


def wrap(angle: float) -> float:
    """Wrap an angle (rad) to (-pi, pi]."""
    return math.pi - (math.pi - angle) % (2 * math.pi)


def to_world(pose: Pose, forward: float, left: float) -> tuple[float, float]:
    """Convert a point from the robot frame (m forward, m left) to the world frame."""
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    return pose.x + c * forward - s * left, pose.y + s * forward + c * left


def to_robot(pose: Pose, x: float, y: float) -> tuple[float, float]:
    """Convert a world point to the robot frame (m forward, m left)."""
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    dx, dy = x - pose.x, y - pose.y
    return c * dx + s * dy, -s * dx + c * dy


def bearing(pose: Pose, x: float, y: float) -> float:
    """Return the angle of a world point off a robot's heading (rad, left positive)."""
    forward, left = to_robot(pose, x, y)
    return math.atan2(left, forward)
