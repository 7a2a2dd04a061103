"""The path feasibility monitor: compares planned and executed trajectory (paper contribution 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True)
class MonitorCfg:
    """Thresholds of the monitor. The paper names the monitor but gives no thresholds."""

    deviation_m: float = 1.0
    """Cross-track distance beyond which the vehicle has left the reference path: twice the widest detour measured
    around an obstacle that was known when the path was planned."""
    max_replans: int = 3
    """Number of new reference paths to one goal, after which the advisor is asked for another goal."""


class PathMonitor:
    """Compares the vehicle's position with the reference path to its goal."""

    def __init__(self, cfg: MonitorCfg | None = None) -> None:
        self.cfg = cfg or MonitorCfg()
        self.path: NDArray[np.float64] = np.empty((0, 2))
        """Reference path, from where it was planned to the goal (m). Shape=(N, 2)."""
        self.replans = 0
        self._last = (0.0, 0.0, np.inf)

    def follow(self, path: NDArray[np.float64], *, new_goal: bool) -> None:
        """Set a newly planned reference path."""
        self.path = path
        self._last = (0.0, 0.0, np.inf)
        self.replans = 0 if new_goal else self.replans + 1

    def deviation(self, x: float, y: float) -> float:
        """Return the distance (m) from a point to the reference path; 0 without a path."""
        return distance_to_path(self.path, x, y)

    def left_path(self, x: float, y: float) -> bool:
        """Check whether the vehicle has left its path by more than the threshold."""
        # The deviation grows by no more than the vehicle moves: most ticks need not search the whole path.
        last_x, last_y, deviation = self._last
        if deviation + math.hypot(x - last_x, y - last_y) < self.cfg.deviation_m - 1e-6:
            return False
        self._last = (x, y, self.deviation(x, y))
        return self._last[2] > self.cfg.deviation_m

    @property
    def exhausted(self) -> bool:
        """Whether the path to this goal has been planned again too often."""
        return self.replans >= self.cfg.max_replans


def distance_to_path(path: NDArray[np.float64], x: float, y: float) -> float:
    """Compute the distance (m) from a point to a polyline, Shape=(N, 2); 0 if it is empty."""
    if len(path) == 0:
        return 0.0
    p = np.array([x, y])
    if len(path) == 1:
        return float(np.linalg.norm(p - path[0]))
    a, d = path[:-1], np.diff(path, axis=0)
    s = np.clip(np.einsum("ij,ij->i", p - a, d) / np.maximum(np.einsum("ij,ij->i", d, d), 1e-12), 0.0, 1.0)
    return float(np.min(np.linalg.norm(p - (a + s[:, None] * d), axis=1)))
