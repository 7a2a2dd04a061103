"""Places from which a reef is worth a picture: clear of obstacles, with oysters ahead."""

from __future__ import annotations

import math

import numpy as np

from coral.errors import InputError
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Label, Pose, wrap
from coral.reef.world.scene import Scene

_FREE_M = 0.35
"""Least distance from the camera to an obstacle: the hull of a vehicle fits."""
_TRIES = 2000


def choose_viewpoints(scene: Scene, count: int, rng: np.random.Generator) -> list[Pose]:
    """Choose poses 0.5 to 5 m from an oyster, at random, that look at it more or less.

    Args:
        scene: Solids of the reef.
        count: Number of poses.
        rng: Source of randomness.

    Raises:
        InputError: There is no room among the obstacles.
    """
    oysters = np.flatnonzero(scene.label == Label.OYSTER)
    hiders = scene.footprints()
    found: list[Pose] = []
    for _ in range(_TRIES + 20 * count):
        if len(found) == count:
            return found
        x, y = scene.center[oysters[rng.integers(len(oysters))], :2]
        away, way = rng.uniform(0.5, 5.0), rng.uniform(-math.pi, math.pi)
        pose = Pose(
            float(x - away * math.cos(way)), float(y - away * math.sin(way)), wrap(way + float(rng.normal(0.0, 0.35)))
        )
        if clearance(hiders, pose.x, pose.y) > _FREE_M:
            found.append(pose)
    if len(found) == count:
        return found
    raise InputError("world", "obstacles", "no room for a camera", f"{count} places near oysters")
