"""The true area of oysters in a simulated reef, to compare with what was measured. No product is made from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.reef.simulation.coverage import rasterise
from coral.reef.vehicle.collision import clearance
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld

RASTER_M = 0.01


@dataclass(frozen=True)
class TrueOysters:
    """The oysters on the floor that a survey of a simulated reef saw near enough; none under obstacles."""

    m2: float
    """Area that oysters cover."""
    oysters: int
    """Number, those that lie beneath others included."""
    length_m: float
    """Mean of their longest axis."""
    whole_m2: float
    """Area that oysters cover on the whole reef, seen or not."""


def true_oysters(world: ReefWorld, seen: NDArray[np.bool_], fine_m: float) -> TrueOysters:
    """Return the true area, number and length of the oysters where a survey has `seen` the floor, Shape=(FY, FX)."""

    def was_seen(xy: NDArray[Any]) -> NDArray[np.bool_]:
        column, row = (np.clip(xy[:, k] / fine_m, 0, seen.shape[1 - k] - 1).astype(np.intp) for k in (0, 1))
        return seen[row, column]

    hiders, covered = Scene.from_world(world).footprints(), _covered(world)
    shells = [one for group in world.clusters for one in group.oysters if clearance(hiders, one.x, one.y) > 0.0]
    found = was_seen(np.array([(one.x, one.y) for one in shells]).reshape(-1, 2))
    lengths = np.array([2.0 * max(one.radii) for one in shells])[found]
    return TrueOysters(
        m2=int(was_seen((covered + 0.5) * RASTER_M).sum()) * RASTER_M**2,
        oysters=len(lengths),
        length_m=float(lengths.mean()) if len(lengths) else 0.0,
        whole_m2=len(covered) * RASTER_M**2,
    )


def _covered(world: ReefWorld) -> NDArray[np.intp]:
    """Return the cells of `RASTER_M` that oysters cover, column and row. Shape=(N, 2)."""
    scene = Scene.from_world(world)
    hiders = scene.footprints()
    points: set[tuple[int, int]] = set()
    for member in np.flatnonzero(scene.cluster >= 0):
        cells = rasterise(scene.outlines(np.array([member])), RASTER_M, 0.0)
        points.update(map(tuple, np.floor(cells / RASTER_M).astype(int).tolist()))
    free = [(i, j) for i, j in sorted(points) if clearance(hiders, (i + 0.5) * RASTER_M, (j + 0.5) * RASTER_M) > 0.0]
    return np.array(free, np.intp).reshape(-1, 2)
