"""Regret of a goal on the true map: duration of the best tour that goes there first (ground truth, for keys alone)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.mapping import distance_to
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.geometry import Pose, to_robot
from coral.reef.world.reachability import HULL_RADIUS_M, free_space, obstacle_outline
from coral.reef.world.world import ReefWorld

THINKING_S = 10.0
"""Median latency of a call in the paper's experiments (IV-E). At a goal reached sooner, the robot waits."""
INSPECTED_M = 2.3
"""Distance (m) from its centre at which a cluster counts as inspected: there the default camera sees its oysters."""


class TrueReef:
    """The true free water and the true clusters of one world."""

    def __init__(self, world: ReefWorld) -> None:
        outlines = [obstacle_outline(obstacle) for obstacle in world.solids]
        space = free_space(world.size_m, outlines, (world.start.x, world.start.y))
        self._cell_m, self._distance = space.cell_m, distance_to(space.solid, space.cell_m)
        self._cfg = CostFieldCfg(radius_m=HULL_RADIUS_M + 0.05, band_m=0.2, penalty=1.0)
        self.clusters: NDArray[np.float64] = np.array(
            [np.mean([(o.x, o.y) for o in cluster.oysters], axis=0) for cluster in world.clusters]
        )
        """Centres of the clusters (m). Shape=(C, 2)."""
        self._fields = [self._field(float(x), float(y)) for x, y in self.clusters]
        x, y = np.ascontiguousarray(self.clusters.T)
        self._between = np.stack([field.lengths(x, y) for field in self._fields])
        self._vehicle = VehicleCfg()

    def seconds(self, pose: Pose, points: NDArray[np.float64], left: Sequence[int]) -> NDArray[np.float64]:
        """Compute, for each first goal, the time until all remaining clusters are inspected in the fastest order (s).

        Args:
            pose: Pose of the robot.
            points: First goals (m). Shape=(N, 2).
            left: Indices of the clusters still to be inspected; at least one.

        Returns:
            Shape=(N,); inf if no path leads to a goal.
        """
        vehicle = self._vehicle
        x, y = np.ascontiguousarray(points.T)
        leg = self._field(pose.x, pose.y).lengths(x, y)
        turn = np.array([_turn(pose, float(px), float(py)) for px, py in points])
        # Reaching a goal before the next answer comes gains nothing.
        first = np.maximum(turn / vehicle.max_yaw_rate_rad_s + leg / vehicle.max_speed_m_s, THINKING_S)
        onward = shortest_path(
            np.stack([self._fields[k].lengths(x, y) for k in left], axis=1), self._between[np.ix_(left, left)]
        )
        return np.asarray(first + onward / vehicle.max_speed_m_s)

    def _field(self, x: float, y: float) -> CostField:
        return CostField.compute(self._distance, (x, y), cell_m=self._cell_m, cfg=self._cfg)


def shortest_path(entry: NDArray[np.float64], between: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the length of the shortest path through all places, exactly (Held and Karp 1962).

    Args:
        entry: Shape=(N, C), from each of N points to each of C places.
        between: Shape=(C, C), from place to place, symmetric.

    Returns:
        Shape=(N,).
    """
    count = len(between)
    # best[S, k]: length of the shortest path that begins at k and visits all of S, where k is in S.
    best = np.full((1 << count, count), math.inf)
    for k in range(count):
        best[1 << k, k] = 0.0
    for members in range(1, 1 << count):
        inside = [k for k in range(count) if members >> k & 1]
        for k in inside if len(inside) > 1 else ():
            rest = members ^ (1 << k)
            best[members, k] = min(between[k, j] + best[rest, j] for j in inside if j != k)
    return np.asarray((entry + best[-1]).min(axis=1))


def _turn(pose: Pose, x: float, y: float) -> float:
    forward, left = to_robot(pose, x, y)
    return abs(math.atan2(left, forward))
