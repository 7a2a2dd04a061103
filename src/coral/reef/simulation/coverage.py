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
from coral.reef.simulation import coverage_kernels
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import Footprints, Scene


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
        self._hiders = hiders = scene.footprints()
        areas = _areas(scene, cfg.cell_m, cfg.closing_m)
        self._size = np.array([len(area) for area in areas], np.int64)
        self._start = np.concatenate([[0], np.cumsum(self._size)])
        self._cells = np.concatenate([np.empty((0, 2)), *areas])
        self._circle = np.array([_circle(area) for area in areas]).reshape(-1, 3)
        self._seen = np.zeros(len(self._cells), np.bool_)
        self._left = self._size.copy()
        self._scratch = np.empty((len(hiders.kind), 7))

    def update(self, pose: Pose) -> None:
        """Mark the area seen from a true pose."""
        cfg = self.cfg
        coverage_kernels.observe(
            (float(pose.x), float(pose.y), float(pose.theta)),
            math.radians(cfg.hfov_deg) / 2,
            cfg.range_m,
            self._cells,
            self._start,
            self._circle,
            self._seen,
            self._left,
            self._hiders,
            self._scratch,
        )

    @property
    def fractions(self) -> NDArray[np.float64]:
        """Return the share of every cluster's area seen so far, in the world's order. Shape=(n_clusters,)."""
        return 1.0 - self._left / self._size

    def covered(self) -> NDArray[np.bool_]:
        """Return which clusters have been seen to at least `cfg.threshold`. Shape=(n_clusters,)."""
        return np.asarray(self._size - self._left >= self.cfg.threshold * self._size - 1e-9)

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
        free = np.array([clearance(hiders, x, y) > 0.0 for x, y in cells])
        areas.append(cells[free] if free.any() else cells)
    return areas


def _circle(cells: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return a circle (x, y, radius) that contains all points."""
    middle = (cells.min(axis=0) + cells.max(axis=0)) / 2
    return float(middle[0]), float(middle[1]), float(np.linalg.norm(cells - middle, axis=1).max())
