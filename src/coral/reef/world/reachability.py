"""What the hull can reach: flood fill of a world's free space from the start."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.world.structures import Obstacle
from coral.reef.world.world_model import ReefWorld

HULL_RADIUS_M = 0.3
"""Paper IV-F: the robot is a disc of 0.3 m radius."""
MARGIN_M = 0.05
"""Margin beside the hull in every passage: one cell of the robot's map."""
VIEW_M = 2.0
"""A cluster is reachable if the hull gets within this distance of one of its oysters, in line of sight."""

_SUBPIXEL = 8
"""Fractional bits of the corners in OpenCV's polygon filling."""
_STRIDE_M = 0.2
"""Spacing of the places from which line of sight is checked."""
_TRIED = 200
"""Largest number of oysters of a cluster to which line of sight is checked."""


@dataclass(frozen=True)
class FreeSpace:
    """Grid of solid cells and cells that the hull can reach, with its origin at (0, 0)."""

    cell_m: float
    """Edge of a cell (m)."""
    solid: NDArray[np.bool_]
    """Cells that touch an obstacle's outline. Shape=(NY, NX)."""
    reachable: NDArray[np.bool_]
    """Cells that the hull's centre can reach from the start. Shape=(NY, NX)."""

    def sees(self, points: NDArray[np.float64], range_m: float = VIEW_M) -> bool:
        """Check whether the hull can get within a range of one of the points, Shape=(N, 2), in line of sight."""
        cells = self._cells(points)
        if self.reachable[cells[:, 1], cells[:, 0]].any():
            return True
        steps = math.floor(range_m / _STRIDE_M)
        offsets = np.stack(np.meshgrid(*[np.arange(-steps, steps + 1) * _STRIDE_M] * 2), axis=-1).reshape(-1, 2)
        offsets = offsets[np.hypot(*offsets.T) <= range_m]
        fractions = np.linspace(0.0, 1.0, math.ceil(range_m / self.cell_m) + 1)
        for point in points:
            places = point + offsets
            at = self._cells(places)
            places = places[self.reachable[at[:, 1], at[:, 0]]]
            if not len(places):
                continue
            rays = self._cells((places[:, None] + fractions[None, :, None] * (point - places)[:, None]).reshape(-1, 2))
            blocked = self.solid[rays[:, 1], rays[:, 0]].reshape(len(places), -1).any(axis=1)
            if not blocked.all():
                return True
        return False

    def _cells(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        top = np.array(self.solid.shape[::-1]) - 1
        return np.clip((points / self.cell_m).astype(np.int64), 0, top)


def free_space(
    size_m: tuple[float, float],
    outlines: Sequence[NDArray[np.float64]],
    start: tuple[float, float],
    radius_m: float = HULL_RADIUS_M + MARGIN_M,
) -> FreeSpace:
    """Flood the free space of a world (m) from the start, for a hull of a radius that holds its margin.

    Outlines are polygons on the ground plane (m), Shape=(K, 2) each: an obstacle blocks at any height.
    """
    cell = 0.05 if max(size_m) <= 40 else 0.1
    shape = math.ceil(size_m[1] / cell - 1e-9), math.ceil(size_m[0] / cell - 1e-9)
    solid = np.zeros(shape, np.uint8)
    for outline in outlines:
        corners = np.rint((outline / cell - 0.5) * (1 << _SUBPIXEL)).astype(np.int32)
        cv2.fillPoly(solid, [corners], 1, shift=_SUBPIXEL)
    distance = np.asarray(cv2.distanceTransform(1 - solid, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)) * cell
    passable = (distance >= radius_m).astype(np.uint8)
    ix, iy = min(int(start[0] / cell), shape[1] - 1), min(int(start[1] / cell), shape[0] - 1)
    # `check_world` checks the start exactly: here, rounding to cells must not shut the vehicle in.
    near = 2 + math.ceil(MARGIN_M / cell)
    passable[max(iy - near, 0) : iy + near + 1, max(ix - near, 0) : ix + near + 1] = 1
    _, parts = cv2.connectedComponents(passable, connectivity=4)
    return FreeSpace(cell, solid.astype(bool), parts == parts[iy, ix])


def unreachable_clusters(world: ReefWorld) -> list[int]:
    """Return the indices of clusters that the hull cannot reach within `VIEW_M`, in line of sight, from the start."""
    outlines = [obstacle_outline(obstacle) for obstacle in world.solids]
    space = free_space(world.size_m, outlines, (world.start.x, world.start.y))
    missing = []
    for k, cluster in enumerate(world.clusters):
        every = math.ceil(len(cluster.oysters) / _TRIED)
        if not space.sees(np.array([(oyster.x, oyster.y) for oyster in cluster.oysters[::every]])):
            missing.append(k)
    return missing


def obstacle_outline(obstacle: Obstacle, corners: int = 48) -> NDArray[np.float64]:
    """Return an obstacle's polygon (m), counter-clockwise: a rectangle, or an ellipse of some corners. Shape=(K, 2)."""
    if obstacle.shape == "box":
        local = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
    else:
        angle = np.arange(corners) * (2 * math.pi / corners)
        local = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    c, s = math.cos(obstacle.yaw), math.sin(obstacle.yaw)
    return np.asarray((local * obstacle.size[:2]) @ np.array([[c, s], [-s, c]]) + (obstacle.x, obstacle.y))


def distance_to(polygon: NDArray[np.float64], x: float, y: float) -> float:
    """Compute the distance (m) from a point to a polygon, negative inside."""
    return -float(cv2.pointPolygonTest(polygon.astype(np.float32), (x, y), measureDist=True))
