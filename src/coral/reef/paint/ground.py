"""The sea floor around solids: their shadows, how much of the sky they hide, and the debris of shells."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from coral.reef.paint.ground_kernels import rasterise_ground
from coral.reef.world.geometry import Label
from coral.reef.world.scene import Scene

_MARGIN_M, _CELL_M, _MOST_CELLS = 3.0, 0.03, 2_000_000


@dataclass(frozen=True)
class SeaFloor:
    """A raster of the sea floor."""

    origin: tuple[float, float]
    """World position of the middle of cell (0, 0) (m)."""
    cell_m: float
    values: NDArray[np.uint8]
    """Share of the sun that is seen, share of the sky, and density of shell debris; 255 stands for 1.
    Shape=(NY, NX, 3)."""

    @classmethod
    @lru_cache(maxsize=2)  # the camera's pictures and the stills are of one scene
    def of(cls, scene: Scene, sun: tuple[float, float, float], softness: float = 0.06) -> SeaFloor:
        """Rasterise a scene; `sun` is a unit vector towards the sun, under water.

        `softness` is the width of a shadow's edge by the distance to what casts it: waves and haze blur the sun.
        """
        if not len(scene):
            return cls((0.0, 0.0), 1.0, np.array([[[255, 255, 0]]], np.uint8))
        low = scene.center[:, :2].min(axis=0) - _MARGIN_M
        extent = scene.center[:, :2].max(axis=0) + _MARGIN_M - low
        cell = max(_CELL_M, float(np.sqrt(extent[0] * extent[1] / _MOST_CELLS)))
        nx, ny = (int(n) + 1 for n in np.ceil(extent / cell))
        values = np.empty((ny, nx, 3), np.float32)
        values[:] = (1.0, 1.0, 0.0)
        rasterise_ground(
            (float(low[0]), float(low[1]), scene.seabed_z),
            cell,
            sun,
            softness,
            scene.solids,
            scene.label == Label.OYSTER,
            values,
        )
        shares = np.round(255.0 * np.minimum(values, 1.0)).astype(np.uint8)
        return cls((float(low[0]), float(low[1])), cell, shares)
