"""The message that robots of one mission exchange at every tick, without loss or delay."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Pose

MOST_ROBOTS = 4


@dataclass(frozen=True, kw_only=True)
class Neighbour:
    """What another robot tells about itself."""

    pose: Pose
    """Pose of the robot, by its own estimate."""
    radius_m: float
    """Radius of its hull."""
    goal: tuple[float, float] | None = None
    """Its goal (m); None while it has nothing to do."""
    index: int | None = None
    """Label of the cluster that its goal stands for."""
    later: frozenset[int] = frozenset()
    """Labels of the clusters that it means to go to after that."""
    path: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    """Its plan: positions from now on (m). Shape=(N, 2)."""
    times: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    """Times of these positions, in seconds from the moment of planning. Shape=(N,)."""

    def is_going_to(self, x: float, y: float, index: int | None, within_m: float) -> bool:
        """Check whether one of its goals is this cluster, or its next one a point within `within_m` of this one (m)."""
        if self.goal is None:
            return False
        if index is not None and index in self.later:
            return True
        return (index is not None and index == self.index) or math.dist(self.goal, (x, y)) < within_m

    def distance_m(self, x: float, y: float) -> float:
        """Return the distance (m) from a point to the robot or to its goal, whichever is nearer."""
        here = math.dist(self.pose[:2], (x, y))
        return here if self.goal is None else min(here, math.dist(self.goal, (x, y)))
