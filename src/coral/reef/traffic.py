"""Other robots as moving obstacles: the water they are about to use, in the controller's distances only."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import NonNegative
from coral.reef.fleet import Neighbour
from coral.reef.geometry import Pose


@dataclass(frozen=True, kw_only=True)
class TrafficCfg:
    """How much water is left to another robot. Beyond the paper, which has one robot."""

    reserve_s: NonNegative = 2.0
    """So much of its plan is kept free for it. It stops within 0.5 s; what it does later it can still change, and
    reserving all 5 s of two robots that meet would leave neither a way past the other."""
    gap_m: NonNegative = 0.1
    """Added to its radius: it does not follow its plan exactly."""
    reach_m: NonNegative = 1.2
    """Farther from it than this nothing changes: beyond the hull and the proximity that the controller prices."""
    hold_m: NonNegative = 0.15
    """With less water than this between two hulls neither drives towards the other. The controller concedes a robot
    that is within its margin already the way to leave, and by that leave one could creep up to another that waits."""


class Traffic:
    """One robot's copy of the distances to obstacles, other robots included. The shared map never holds them."""

    def __init__(self, cfg: TrafficCfg | None = None) -> None:
        self.cfg = cfg or TrafficCfg()
        self._own: NDArray[np.float32] = np.empty((0, 0), np.float32)

    def stamped(
        self, distance: NDArray[np.float32], cell_m: float, pose: Pose, others: Sequence[Neighbour]
    ) -> NDArray[np.float32]:
        """Return distances to obstacles and to the water that the others are about to use.

        Every robot keeps clear of what the others have reserved and reserves what it plans, one after the other, so
        that no two reservations overlap and each can always stop within its own.

        Args:
            distance: Shape=(H, W) distances to the nearest obstacle (m); left as it is.
            cell_m: Edge of a cell (m).
            pose: Of this robot.
            others: What the other robots say.

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
        """Return the command, stopped where it would bring this robot nearer to one that is already close.

        Args:
            command: Forward speed (m/s) and yaw rate (rad/s).
            pose: Of this robot, whose hull is as wide as theirs.
            others: What the other robots say.
        """
        for other in others:
            east, north = other.pose.x - pose.x, other.pose.y - pose.y
            close = math.hypot(east, north) < 2.0 * other.radius_m + self.cfg.hold_m
            if close and command[0] * (math.cos(pose.theta) * east + math.sin(pose.theta) * north) > 0.0:
                return 0.0, command[1]
        return command

    def reserved(self, other: Neighbour, pose: Pose) -> NDArray[np.float64]:
        """Return the line that another robot's centre is about to follow. Shape=(N, 2), metres.

        It ends before it reaches this robot, whose water the other keeps clear of in its turn.
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
    """Lower distances, in place, to those from a band around a line; nothing changes beyond `reach_m` of the band.

    Args:
        distance: Shape=(H, W), metres; cell (0, 0) at the world's origin.
        cell_m: Edge of a cell (m).
        line: Shape=(N, 2), N >= 1, world points (m).
        radius_m: Half the width of the band.
        reach_m: How far about the band distances are looked at.
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
