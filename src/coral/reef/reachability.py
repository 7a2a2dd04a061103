"""Proof that a world can be surveyed: the robot's disc can get from the start to every cluster."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.collision import clearance
from coral.reef.scene import Scene
from coral.reef.world import ReefWorld

HULL_RADIUS_M = 0.3
"""Robot disc (paper IV-F)."""
CELL_M = 0.1
MARGIN_M = 0.1
"""Kept beyond the hull, so that a passage is not only wide enough on paper."""
VIEW_M = 2.0
"""A cluster is reached when the robot can come this close to its centre."""


def free_space(world: ReefWorld, cell_m: float = CELL_M, margin_m: float = MARGIN_M) -> NDArray[np.bool_]:
    """Cells in which the robot's centre has hull and margin of clearance. Shape=(NY, NX), cell (0, 0) at the origin."""
    footprints = Scene.from_world(world).footprints()
    ny, nx = math.ceil(world.size_m[1] / cell_m), math.ceil(world.size_m[0] / cell_m)
    free = np.ones((ny, nx), np.bool_)
    need = HULL_RADIUS_M + margin_m
    for obstacle in world.obstacles:
        reach = max(obstacle.size[:2]) * math.sqrt(2) + need
        y0, y1 = max(int((obstacle.y - reach) / cell_m), 0), min(int((obstacle.y + reach) / cell_m) + 1, ny)
        x0, x1 = max(int((obstacle.x - reach) / cell_m), 0), min(int((obstacle.x + reach) / cell_m) + 1, nx)
        for iy in range(y0, y1):
            for ix in range(x0, x1):
                if free[iy, ix]:
                    free[iy, ix] = clearance(footprints, (ix + 0.5) * cell_m, (iy + 0.5) * cell_m) >= need
    return free


def reachable_space(world: ReefWorld, cell_m: float = CELL_M, margin_m: float = MARGIN_M) -> NDArray[np.bool_]:
    """The part of the free space that is connected with the start. Shape=(NY, NX)."""
    free = free_space(world, cell_m, margin_m)
    iy = min(int(world.start.y / cell_m), free.shape[0] - 1)
    ix = min(int(world.start.x / cell_m), free.shape[1] - 1)
    free[iy, ix] = True
    _, labels = cv2.connectedComponents(free.astype(np.uint8), connectivity=4)
    return np.asarray(labels == labels[iy, ix])


def unreachable_clusters(world: ReefWorld) -> list[int]:
    """Indices of the clusters whose centre the robot cannot come within `VIEW_M` of."""
    space = reachable_space(world)
    ys, xs = np.nonzero(space)
    px, py = (xs + 0.5) * CELL_M, (ys + 0.5) * CELL_M
    missing = []
    for k, cluster in enumerate(world.clusters):
        cx = sum(o.x for o in cluster.oysters) / len(cluster.oysters)
        cy = sum(o.y for o in cluster.oysters) / len(cluster.oysters)
        if not np.any(np.hypot(px - cx, py - cy) <= VIEW_M):
            missing.append(k)
    return missing
