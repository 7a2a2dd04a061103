"""Geodesic cost-to-go: the distance to the goal around known obstacles, from every point of the map."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Count
from coral.reef.map.costfield_kernels import descend, extend, lookup, lookup_many, march, slowness

UNREACHABLE = "goal unreachable"
NO_FREE_CELL = "no free cell in the map"

_LEAST_MARGIN_M = 6.0
"""Least width of the rim of a window about robot and goal."""
_AROUND_M = 4.0
"""How much more than the robot's own cost-to-go is exact in a window: its plans look 3 m ahead."""


@dataclass(frozen=True, kw_only=True)
class CostFieldCfg:
    """Grid and clearance of the cost-to-go. The paper describes no cost-to-go."""

    ratio: Count = 2
    """Map cells per field cell and axis: 0.1 m field cells on a 0.05 m map, three across the narrowest passage."""
    radius_m: float = 0.35
    """Least clearance of the robot's centre: the hull's 0.3 m and one map cell."""
    band_m: float = 0.5
    penalty: float = 3.0
    """Water at contact costs 1 + penalty times as much as open water, so paths keep away from obstacles if they can."""
    steepness: float = 10.0
    """Cost per metre inside the blocked band: more than any detour."""


@dataclass(frozen=True)
class CostField:
    """Cost-to-go to one goal."""

    value: NDArray[np.float32]
    """Metres of open water to go; finite everywhere. Shape=(h, w), float32."""
    cell_m: float
    """Edge of a field cell (m); cell (0, 0) at the world's origin."""
    goal: tuple[float, float]
    """Goal that was asked for, (x, y) (m)."""
    target: tuple[float, float]
    """Point to which the field leads, (x, y) (m): the goal, or the free cell nearest to it."""
    reached: NDArray[np.bool_] | None = None
    """Cells from which a path leads to the goal; None for a straight field. Shape=(h, w)."""
    failure: str = ""
    """Reason why there is no field, or ""."""

    @classmethod
    def over(
        cls,
        slowness: NDArray[np.float32],
        goal: tuple[float, float],
        *,
        start: tuple[float, float] | None = None,
        cell_m: float = 0.1,
        cfg: CostFieldCfg | None = None,
    ) -> CostField:
        """Compute the cost-to-go over water whose cost per metre is known, Shape=(h, w); negative: blocked.

        Unknown water can be crossed, the map's edge cannot. With the robot's `start` (m), a goal without a path from
        there is a `failure`.
        """
        cfg = cfg or CostFieldCfg()
        h, w = slowness.shape
        j0 = min(max(math.floor(goal[1] / cell_m), 0), h - 1)
        i0 = min(max(math.floor(goal[0] / cell_m), 0), w - 1)
        j, i = nearest_free(slowness, j0, i0)
        if j < 0:
            return cls(np.zeros_like(slowness), cell_m, goal, goal, failure=NO_FREE_CELL)
        target = goal if (j, i) == (j0, i0) else ((i + 0.5) * cell_m, (j + 0.5) * cell_m)
        value = march(slowness, cell_m, j, i, target[0], target[1], 1.0 + cfg.penalty)
        reached = np.isfinite(value)
        extend(value, cell_m, cfg.steepness)
        field = cls(value, cell_m, goal, target, reached)
        if start is not None and not field.reaches(*start, within_m=2.0 * cfg.radius_m):
            return cls(value, cell_m, goal, target, reached, failure=UNREACHABLE)
        return field

    @classmethod
    def between(
        cls,
        slowness: NDArray[np.float32],
        start: tuple[float, float],
        goal: tuple[float, float],
        *,
        cell_m: float = 0.1,
        cfg: CostFieldCfg | None = None,
        most_cells: int | None = None,
    ) -> CostField | None:
        """Compute the cost-to-go of a robot on its way to a goal, over a window about both, as `over` does.

        The window is so large that no path from the robot's surroundings that leaves it can be shorter; it grows to
        the whole map if no path is found. Outside of it the cost-to-go is a constant, larger than inside. None if more
        than `most_cells` have to be searched.
        """
        cfg = cfg or CostFieldCfg()
        h, w = slowness.shape
        apart, searched = math.dist(start, goal), 0
        margin_m = max(_LEAST_MARGIN_M, 0.3 * apart + _AROUND_M)
        while True:
            low = [min(start[k], goal[k]) - margin_m for k in (0, 1)]
            high = [max(start[k], goal[k]) + margin_m for k in (0, 1)]
            i0, i1 = max(math.floor(low[0] / cell_m), 0), min(math.ceil(high[0] / cell_m), w)
            j0, j1 = max(math.floor(low[1] / cell_m), 0), min(math.ceil(high[1] / cell_m), h)
            searched += max(j1 - j0, 0) * max(i1 - i0, 0)
            if (j1 - j0, i1 - i0) == (h, w) or j1 <= j0 or i1 <= i0:
                if most_cells is not None and max(searched, h * w) > most_cells:
                    return None
                return cls.over(slowness, goal, start=start, cell_m=cell_m, cfg=cfg)
            if most_cells is not None and searched > most_cells:
                return None
            x0, y0 = i0 * cell_m, j0 * cell_m
            part = np.ascontiguousarray(slowness[j0:j1, i0:i1])
            shifted = (goal[0] - x0, goal[1] - y0)
            field = cls.over(part, shifted, start=(start[0] - x0, start[1] - y0), cell_m=cell_m, cfg=cfg)
            # A path that leaves the window is at least as long as one to the goal mirrored at the window's edge.
            longest_m = (field.lookup(start[0] - x0, start[1] - y0) if field.ok else math.inf) + _AROUND_M
            if longest_m <= math.hypot(apart, 2.0 * margin_m):
                value = np.full((h, w), field.value.max() + 1.0, np.float32)
                value[j0:j1, i0:i1] = field.value
                reached = np.zeros((h, w), np.bool_)
                assert field.reached is not None
                reached[j0:j1, i0:i1] = field.reached
                target = goal if field.target == shifted else (field.target[0] + x0, field.target[1] + y0)
                return cls(value, cell_m, goal, target, reached)
            margin_m = max(
                1.2 * margin_m,
                2.0 * margin_m if math.isinf(longest_m) else 0.5 * math.sqrt(longest_m**2 - apart**2) + cell_m,
            )

    @classmethod
    def straight(cls, shape: tuple[int, int], goal: tuple[float, float], *, cell_m: float = 0.05) -> CostField:
        """Return the Euclidean distance to the goal over a map of `shape`, as a planner without a map would use it."""
        cell = 2.0 * cell_m
        h, w = (shape[0] + 1) // 2, (shape[1] + 1) // 2
        x, y = (np.arange(w) + 0.5) * cell - goal[0], (np.arange(h) + 0.5) * cell - goal[1]
        return cls(np.hypot(x[None, :], y[:, None]).astype(np.float32), cell, goal, goal)

    @property
    def ok(self) -> bool:
        """Whether the goal can be reached."""
        return not self.failure

    def lookup(self, x: float, y: float) -> float:
        """Return the cost-to-go (m) at a world point."""
        return float(lookup(self.value, self.cell_m, x, y)[0])

    def reaches(self, x: float, y: float, within_m: float = 0.0) -> bool:
        """Check whether a path leads to the goal from some cell within `within_m` of a point."""
        if self.reached is None:
            return True
        h, w = self.reached.shape
        n = math.ceil(within_m / self.cell_m)
        j, i = min(max(int(y / self.cell_m), 0), h - 1), min(max(int(x / self.cell_m), 0), w - 1)
        return bool(self.reached[max(j - n, 0) : j + n + 1, max(i - n, 0) : i + n + 1].any())

    def lengths(self, xs: NDArray[np.float64], ys: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the cost-to-go (m) at many world points, inf where no path leads to the goal. Shape=(N,)."""
        values = lookup_many(self.value, self.cell_m, np.ascontiguousarray(xs), np.ascontiguousarray(ys))
        if self.reached is None:
            return np.asarray(values)
        h, w = self.reached.shape
        j = np.clip((ys / self.cell_m).astype(np.int64), 0, h - 1)
        i = np.clip((xs / self.cell_m).astype(np.int64), 0, w - 1)
        return np.where(self.reached[j, i], values, np.inf)

    def path_from(self, x: float, y: float, step_m: float = 0.1, length_m: float = 100.0) -> NDArray[np.float64]:
        """Return the steepest descent to the goal, points `step_m` apart, at most `length_m` long. Shape=(n, 2)."""
        n_max = math.ceil(length_m / step_m)
        path = descend(self.value, self.cell_m, x, y, self.target[0], self.target[1], step_m, n_max)
        return np.asarray(path, dtype=np.float64)


def slowness_over(distance: NDArray[np.float32], cell_m: float, cfg: CostFieldCfg) -> NDArray[np.float32]:
    """Compute the `slowness` of a map, Shape=(H, W). Shape=(h, w)."""
    shape = math.ceil(distance.shape[0] / cfg.ratio), math.ceil(distance.shape[1] / cfg.ratio)
    out, fine = np.empty(shape, np.float32), np.ascontiguousarray(distance, np.float32)
    slowness(fine, cell_m, cfg.ratio, cfg.radius_m, cfg.band_m, cfg.penalty, out)
    return out


def nearest_free(slowness: NDArray[np.float32], j: int, i: int) -> tuple[int, int]:
    """Return (row, column) of the free cell nearest to a cell; (-1, -1) if none is free."""
    if slowness[j, i] > 0.0:
        return j, i
    rows, columns = np.nonzero(slowness > 0.0)
    if not rows.size:
        return -1, -1
    best = int(np.argmin((rows - j) ** 2 + (columns - i) ** 2))
    return int(rows[best]), int(columns[best])
