"""Distances to given obstacles on the ground plane, and a counter of contacts, for simulator and judge.

The check of the vehicle's own rollouts (Eq. 11) is in `drive/controller_kernels.py`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle import collision_kernels
from coral.reef.world.scene import Footprints


def clearance(footprints: Footprints, x: float, y: float) -> float:
    """Return the signed distance (m) from a point to the nearest obstacle's outline, negative inside, inf without any.

    The world's border does not count. Exact for circles and rectangles, within 1e-9 m for ellipses.
    """
    distances = collision_kernels.distances_along(np.array([[x, y]], np.float64), math.inf, footprints)
    return float(distances.min(initial=math.inf))


class ContactCounter:
    """Counts collisions of a disc: one each time it begins to touch an obstacle.

    A contact lasts until the disc is more than `release_m` away, so sliding along a rock is one collision.
    """

    def __init__(self, footprints: Footprints, radius: float = 0.3, release_m: float = 0.05) -> None:
        self.count = 0
        """Contacts so far."""
        self._footprints = footprints
        self._radius, self._release = radius, release_m
        self._touching: NDArray[np.bool_] = np.zeros(len(footprints.kind), np.bool_)

    def clearance(self, x: float, y: float) -> float:
        """Return the distance (m) from the disc, its centre at (x, y), to the nearest obstacle; negative in contact."""
        return clearance(self._footprints, x, y) - self._radius

    def follow(self, track: NDArray[np.float64]) -> list[tuple[float, float, int]]:
        """Move the centre along a track, Shape=(N, 2), metres. Return new contacts: x, y, index of the obstacle."""
        reach, found = self._radius + self._release, list[tuple[float, float, int]]()
        gaps = collision_kernels.distances_along(track, reach, self._footprints) - self._radius
        for (x, y), gap in zip(track, gaps, strict=True):
            begun = ~self._touching & (gap <= 0.0)
            self._touching = begun | (self._touching & (gap <= self._release))
            found += [(float(x), float(y), int(k)) for k in np.flatnonzero(begun)]
        self.count += len(found)
        return found
