"""The true area of oysters in a simulated reef, to compare with what was measured. No product is made from it."""

from __future__ import annotations

import numpy as np

from coral.reef.collision import clearance
from coral.reef.coverage import rasterise
from coral.reef.geometry import Label
from coral.reef.scene import Scene
from coral.reef.world import ReefWorld

RASTER_M = 0.01


def true_area_m2(world: ReefWorld) -> float:
    """Return the area that oysters cover on the sea floor, seen from above (m²).

    It is the union of the shells' vertical projections: shells that overlap count once, gaps between shells do not
    count. What lies under an obstacle is left out, as in all true areas here.
    """
    scene = Scene.from_world(world)
    hiders = scene.footprints()
    points: set[tuple[int, int]] = set()
    for member in np.flatnonzero(scene.label == Label.OYSTER):
        cells = rasterise(scene.outlines(np.array([member])), RASTER_M, 0.0)
        points.update(map(tuple, np.floor(cells / RASTER_M).astype(int).tolist()))
    free = sum(clearance(hiders, (i + 0.5) * RASTER_M, (j + 0.5) * RASTER_M) > 0.0 for i, j in points)
    return free * RASTER_M**2
