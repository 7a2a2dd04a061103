"""Other robots as moving obstacles: the water that they will use next, in the controller's distances only."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import NonNegative
from coral.reef.vehicle.fleet import Neighbour
from coral.reef.world.geometry import Pose


@dataclass(frozen=True, kw_only=True)
class TrafficCfg:
    """Space left to another robot. The paper has only one robot."""

    reserve_s: NonNegative = 2.0
    """Duration of its plan that is kept free for it. It stops within 0.5 s and can still change what it does later.
    Reserving all 5 s would leave two robots that meet no way past each other."""
    gap_m: NonNegative = 0.1
    """Gap added to its radius, since it does not follow its plan exactly."""
    reach_m: NonNegative = 1.2
    """Distance from it beyond which nothing changes: more than the hull and the proximity that has a cost."""
    hold_m: NonNegative = 0.15
    """Gap between two hulls below which neither drives towards the other. The controller lets a robot that is already
    within the margin leave it; by this exception one robot could creep up to another that waits."""


class Traffic:
    """Keeps one robot's distances to obstacles and other robots. The shared map never holds robots."""

    def __init__(self, cfg: TrafficCfg | None = None) -> None:
        self.cfg = cfg or TrafficCfg()
        self._own: NDArray[np.float32] = np.empty((0, 0), np.float32)

    def stamped(
        self, distance: NDArray[np.float32], cell_m: float, pose: Pose, others: Sequence[Neighbour]
    ) -> NDArray[np.float32]:
        """Return distances to obstacles and to the water that the other robots will use next.

        One after the other, every robot avoids what the others have reserved and reserves what it plans. So no two
        reservations overlap, and each robot can always stop within its own.

        Args:
            distance: Shape=(H, W), distances to the nearest obstacle (m), not changed.
            cell_m: Edge of a cell (m).
            pose: Pose of this robot.
            others: Messages of the other robots.

        Returns:
            Shape=(H, W), valid until the next call.
        """
        if self._own.shape != distance.shape:
            self._own = np.empty_like(distance)
        np.copyto(self._own, distance)
        for other in others:
            lower_to_path(
                self._own, cell_m, self.reserved(other, pose), other.radius_m + self.cfg.gap_m, self.cfg.reach_m
            )
        return self._own

    def held(self, command: tuple[float, float], pose: Pose, others: Sequence[Neighbour]) -> tuple[float, float]:
        """Return the command, with no speed if it would bring this robot nearer to one that is already close.

        Args:
            command: Forward speed (m/s) and yaw rate (rad/s).
            pose: Pose of this robot, whose hull is as wide as theirs.
            others: Messages of the other robots.
        """
        for other in others:
            east, north = other.pose.x - pose.x, other.pose.y - pose.y
            close = math.hypot(east, north) < 2.0 * other.radius_m + self.cfg.hold_m
            if close and command[0] * (math.cos(pose.theta) * east + math.sin(pose.theta) * north) > 0.0:
                return 0.0, command[1]
        return command

    def reserved(self, other: Neighbour, pose: Pose) -> NDArray[np.float64]:
        """Return the line that another robot's centre will follow next (m). Shape=(N, 2).

        It ends before it reaches this robot: the other robot keeps clear of this robot's water.
        """
        here = np.array([other.pose[:2]])
        soon = other.path[(other.times > 0.0) & (other.times <= self.cfg.reserve_s)]
        line = np.concatenate([here, soon])
        # Hulls, the gap on either side, and two map cells of the controller's margin.
        least = 2.0 * (other.radius_m + self.cfg.gap_m) + 0.1
        too_near = np.flatnonzero(np.hypot(line[:, 0] - pose.x, line[:, 1] - pose.y) < least)
        return line[: max(1, int(too_near[0]))] if too_near.size else line


def lower_to_path(
    distance: NDArray[np.float32], cell_m: float, line: NDArray[np.float64], radius_m: float, reach_m: float
) -> None:
    """Lower distances, in place, to those from a band around a line. Beyond `reach_m` of the band nothing changes.

    Args:
        distance: Shape=(H, W), metres; cell (0, 0) at the world's origin.
        cell_m: Edge of a cell (m).
        line: Shape=(N, 2), N >= 1, world points (m).
        radius_m: Half the width of the band (m).
        reach_m: Distance from the band up to which distances change (m).
    """
    h, w = distance.shape
    around = radius_m + reach_m
    ends = np.concatenate([line[1:], line[-1:]]) if len(line) == 1 else line[1:]
    for a, b in zip(line[: len(ends)], ends, strict=True):
        low, high = np.minimum(a, b) - around, np.maximum(a, b) + around
        i0, i1 = max(math.floor(low[0] / cell_m), 0), min(math.ceil(high[0] / cell_m), w)
        j0, j1 = max(math.floor(low[1] / cell_m), 0), min(math.ceil(high[1] / cell_m), h)
        if i0 >= i1 or j0 >= j1:
            continue
        x = (np.arange(i0, i1)[None, :] + 0.5) * cell_m - a[0]
        y = (np.arange(j0, j1)[:, None] + 0.5) * cell_m - a[1]
        d = b - a
        s = np.clip((x * d[0] + y * d[1]) / max(float(d @ d), 1e-12), 0.0, 1.0)
        gap = np.maximum(np.hypot(x - s * d[0], y - s * d[1]) - radius_m, 0.0)
        patch = distance[j0:j1, i0:i1]
        np.minimum(patch, np.where(gap <= reach_m, gap, np.inf), out=patch, casting="same_kind")
