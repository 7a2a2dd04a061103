"""The water that the robot can cross: the grid of its cost-to-go."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.map.costfield import CostFieldCfg, nearest_free, slowness_over


@dataclass(frozen=True)
class Water:
    """Cost of every coarse cell of a map."""

    slowness: NDArray[np.float32]
    """Cost per metre; negative where the hull does not fit. Shape=(h, w)."""
    cell_m: float
    """Edge of a cell (m); cell (0, 0) at the world's origin."""
    cfg: CostFieldCfg

    @classmethod
    def over(cls, distance: NDArray[np.float32], cell_m: float, cfg: CostFieldCfg) -> Water:
        """Return the water of a map whose cells are so far from the nearest obstacle (m), Shape=(H, W)."""
        return cls(slowness_over(distance, cell_m, cfg), cell_m * cfg.ratio, cfg)

    def kept_from(self, places: Sequence[tuple[float, float]], clear_m: float) -> Water:
        """Return water that costs more the nearer it is to one of these places, from `clear_m` (m) on."""
        if not places or not clear_m:
            return self
        slowness = self.slowness.copy()
        rows, columns = ((np.arange(n) + 0.5) * self.cell_m for n in slowness.shape)
        for x, y in places:
            near = 1.0 - np.hypot(columns[None, :] - x, rows[:, None] - y) / clear_m
            more = (1.0 + self.cfg.penalty * np.clip(near, 0.0, 1.0)).astype(np.float32)
            slowness = np.where(slowness > 0.0, np.maximum(slowness, more), slowness)
        return replace(self, slowness=slowness)

    def reach(self, x: float, y: float) -> Reach:
        """Find what can be reached from a point."""
        h, w = self.slowness.shape
        j, i = min(max(int(y / self.cell_m), 0), h - 1), min(max(int(x / self.cell_m), 0), w - 1)
        j, i = nearest_free(self.slowness, j, i)
        free = self.slowness > 0.0
        parts = np.asarray(cv2.connectedComponents(free.astype(np.uint8), connectivity=4)[1], np.int32)
        # The search of a cost-to-go begins with the cells around the start's, joined or not.
        near = np.s_[max(j - 1, 0) : j + 2, max(i - 1, 0) : i + 2]
        starts = np.asarray(np.unique(parts[near][free[near]]), np.int32) if j >= 0 else np.empty(0, np.int32)
        return Reach(parts, starts, self.cell_m)


@dataclass(frozen=True)
class Reach:
    """Which parts of the water are joined to a point."""

    parts: NDArray[np.int32]
    """Number of the part that each cell belongs to. Shape=(h, w)."""
    starts: NDArray[np.int32]
    """Numbers of the parts that can be reached. Shape=(n,)."""
    cell_m: float

    def reaches(self, x: float, y: float, within_m: float = 0.7) -> bool:
        """Check whether some cell within `within_m` of a point can be reached."""
        h, w = self.parts.shape
        n = math.ceil(within_m / self.cell_m)
        j, i = min(max(int(y / self.cell_m), 0), h - 1), min(max(int(x / self.cell_m), 0), w - 1)
        near = self.parts[max(j - n, 0) : j + n + 1, max(i - n, 0) : i + n + 1]
        return bool(np.isin(near, self.starts).any())
