"""Ground truth of the coverage metric: the share of every oyster cluster that has been in view (paper IV-E)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import CellSize, Positive
from coral.reef.vehicle.collision_kernels import distances_along
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import ELLIPSE, Footprints, Scene


@dataclass(frozen=True, kw_only=True)
class CoverageCfg:
    """Definitions of a cluster's area and of observed."""

    cell_m: CellSize = 0.05
    """Edge of a cell of the true area; the same as in the robot's map."""
    closing_m: Annotated[float, Field(ge=0, le=5)] = 0.15
    """Gaps narrower than twice this between a cluster's oysters belong to its area (morphological closing). The outer
    edge stays where the oysters end."""
    hfov_deg: Annotated[float, Field(gt=0, le=360)] = 120.0
    """Paper IV-E: observed means within the camera's 120° field of view."""
    range_m: Positive = 6.0
    """The paper gives no limit; its prompts speak of 0-6 m."""
    threshold: Annotated[float, Field(gt=0, le=1)] = 0.6
    """Paper IV-E: a cluster is covered when at least 60 % of its area has been observed."""


class CoverageMeter:
    """Marks the true oyster area seen from the true pose. No decision reads it.

    A cell is seen when its centre lies within range and field of view of the body's origin and the straight line to it
    on the ground plane crosses no obstacle's outline. The obstacle's height does not count. Cells under an obstacle
    can never be seen and are not part of the area.
    """

    def __init__(self, scene: Scene, cfg: CoverageCfg | None = None) -> None:
        self.cfg = cfg = cfg or CoverageCfg()
        self.names = scene.cluster_names
        self._hiders = scene.footprints()
        areas = _areas(scene, cfg.cell_m, cfg.closing_m)
        self._size = np.array([len(area) for area in areas], np.int64)
        self._cells = np.concatenate([np.empty((0, 2)), *areas])
        self._cluster = np.repeat(np.arange(len(areas)), self._size)
        self._seen = np.zeros(len(self._cells), np.bool_)

    def update(self, pose: Pose) -> None:
        """Mark the area seen from a true pose."""
        unseen = np.flatnonzero(~self._seen)
        dx, dy = self._cells[unseen, 0] - pose.x, self._cells[unseen, 1] - pose.y
        distance = np.sqrt(dx * dx + dy * dy)
        ahead = math.cos(pose.theta) * dx + math.sin(pose.theta) * dy
        edge = math.cos(math.radians(self.cfg.hfov_deg) / 2)
        near = (distance <= self.cfg.range_m) & (ahead >= edge * distance)
        hidden = self._hidden(pose, dx[near], dy[near])
        self._seen[unseen[near][~hidden]] = True

    def _hidden(self, pose: Pose, dx: NDArray[np.float64], dy: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Check whether the segments from a pose to pose + (dx, dy) cross an outline. Shape=(N,)."""
        hidden = np.zeros(len(dx), np.bool_)
        for kind, (x, y), half, yaw in zip(*self._hiders, strict=True):
            x, y = pose.x - x, pose.y - y
            reach = self.cfg.range_m + half[0] + half[1]
            if not len(dx) or x * x + y * y > reach * reach:
                continue
            # In the frame in which the outline is the unit circle or square: the eye e and the segment g.
            c, s = math.cos(yaw), math.sin(yaw)
            rows = (c / half[0], s / half[0]), (-s / half[1], c / half[1])
            (ex, ey), (gx, gy) = ((a * x + b * y for a, b in rows), (a * dx + b * dy for a, b in rows))
            if kind == ELLIPSE:
                square, near = gx * gx + gy * gy, -(ex * gx + ey * gy)
                near = np.clip(near / np.maximum(square, 1e-300), 0.0, 1.0)
                px, py = ex + near * gx, ey + near * gy
                hidden |= px * px + py * py < 1.0
                continue
            enter, leave = np.zeros(len(dx)), np.ones(len(dx))
            for e, g in ((ex, gx), (ey, gy)):
                with np.errstate(divide="ignore", invalid="ignore"):  # a segment along an edge: all of it, or nothing
                    first, second = (-1.0 - e) / g, (1.0 - e) / g
                enter = np.maximum(enter, np.minimum(first, second))
                leave = np.minimum(leave, np.maximum(first, second))
            hidden |= enter < leave
        return hidden

    @property
    def fractions(self) -> NDArray[np.float64]:
        """Return the share of every cluster's area seen so far, in the world's order. Shape=(n_clusters,)."""
        return 1.0 - self._left() / self._size

    def covered(self) -> NDArray[np.bool_]:
        """Return which clusters have been seen to at least `cfg.threshold`. Shape=(n_clusters,)."""
        return np.asarray(self._size - self._left() >= self.cfg.threshold * self._size - 1e-9)

    def _left(self) -> NDArray[np.int64]:
        """Return the number of cells of every cluster that have not been seen. Shape=(n_clusters,)."""
        return np.bincount(self._cluster[~self._seen], minlength=len(self.names))

    @property
    def coverage(self) -> float:
        """Coverage rate, N_cov / N_total, between 0 and 1 (paper IV-E)."""
        return float(self.covered().sum()) / max(len(self.names), 1)


def rasterise(outlines: Footprints, cell_m: float, closing_m: float) -> NDArray[np.float64]:
    """Return the centres of the cells in the closed union of ellipses, row by row (m). Shape=(M, 2).

    A cell belongs to an ellipse if the cell's centre lies in the ellipse or the ellipse's centre in the cell.
    """
    margin = closing_m + 2 * cell_m
    reach = outlines.half.max(axis=1, keepdims=True)
    low = np.floor(((outlines.center - reach).min(axis=0) - margin) / cell_m).astype(int)
    high = np.ceil(((outlines.center + reach).max(axis=0) + margin) / cell_m).astype(int)
    mask = np.zeros((high[1] - low[1], high[0] - low[0]), np.uint8)
    for (x, y), half, yaw, size in zip(outlines.center, outlines.half, outlines.yaw, reach[:, 0], strict=True):
        ix0, ix1 = (math.floor((x + sign * size) / cell_m) for sign in (-1, 1))
        iy0, iy1 = (math.floor((y + sign * size) / cell_m) for sign in (-1, 1))
        dx = (np.arange(ix0, ix1 + 1) + 0.5)[None, :] * cell_m - x
        dy = (np.arange(iy0, iy1 + 1) + 0.5)[:, None] * cell_m - y
        c, s = math.cos(yaw), math.sin(yaw)
        inside = ((c * dx + s * dy) / half[0]) ** 2 + ((c * dy - s * dx) / half[1]) ** 2 <= 1.0
        mask[iy0 - low[1] : iy1 + 1 - low[1], ix0 - low[0] : ix1 + 1 - low[0]] |= inside.astype(np.uint8)
        mask[math.floor(y / cell_m) - low[1], math.floor(x / cell_m) - low[0]] = 1
    n = math.floor(closing_m / cell_m + 1e-9)
    if n:
        offsets = np.arange(-n, n + 1)
        disc = (offsets[:, None] ** 2 + offsets[None, :] ** 2 <= (closing_m / cell_m) ** 2 + 1e-9).astype(np.uint8)
        mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, disc)
    iy, ix = np.nonzero(mask)
    return np.stack([ix + low[0] + 0.5, iy + low[1] + 0.5], axis=1) * cell_m


@lru_cache(maxsize=4)
def _areas(scene: Scene, cell_m: float, closing_m: float) -> list[NDArray[np.float64]]:
    """Return the cells of every cluster that no obstacle stands on (m), each Shape=(M, 2)."""
    hiders, areas = scene.footprints(), []
    for index in range(len(scene.cluster_names)):
        members = np.flatnonzero((scene.cluster == index) & (scene.label == Label.OYSTER))
        cells = rasterise(scene.outlines(members), cell_m, closing_m)
        free = (distances_along(cells, 0.0, hiders) > 0.0).all(axis=1)
        areas.append(cells[free] if free.any() else cells)
    return areas
