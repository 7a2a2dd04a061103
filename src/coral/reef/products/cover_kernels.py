"""Hot loops of the products: where pixels lie on the sea floor, and their votes for oysters there."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

NOWHERE = -1


@njit(cache=True)
def locate_pixels(
    depth: NDArray[np.float32],
    transform: NDArray[np.float64],
    lens: tuple[float, float, float],
    range_m: float,
    cell_m: float,
    shape: tuple[int, int],
    cell: NDArray[np.int64],
    away: NDArray[np.float64],
) -> None:
    """Find the cell of a grid over the sea floor in which each pixel's point lies, its height left out (Eq. 1).

    Args:
        depth: Shape=(H, W), metres along the optical axis; inf where nothing is seen.
        transform: Shape=(4, 4), camera optical frame to world.
        lens: Focal length and principal point (px).
        range_m: Largest distance along the line of sight (m).
        cell_m: Edge of a cell (m).
        shape: (NY, NX) of the grid.
        cell: Shape=(H, W), iy NX + ix, or NOWHERE; written.
        away: Shape=(H, W), distance along the line of sight (m) where there is a cell; written.
    """
    ny, nx = shape
    height, width = depth.shape
    focal, cx, cy = lens
    for v in range(height):
        q = (v - cy) / focal
        for u in range(width):
            cell[v, u] = NOWHERE
            z = depth[v, u]
            if not z < np.inf:
                continue
            p = (u - cx) / focal
            away[v, u] = z * math.sqrt(1.0 + p * p + q * q)
            if away[v, u] > range_m:
                continue
            x = transform[0, 3] + z * (transform[0, 0] * p + transform[0, 1] * q + transform[0, 2])
            y = transform[1, 3] + z * (transform[1, 0] * p + transform[1, 1] * q + transform[1, 2])
            ix, iy = int(math.floor(x / cell_m)), int(math.floor(y / cell_m))
            if ix >= 0 and iy >= 0 and ix < nx and iy < ny:
                cell[v, u] = iy * nx + ix


@njit(cache=True)
def vote(
    cell: NDArray[np.int64],
    depth: NDArray[np.float32],
    likely: NDArray[np.float32],
    oyster: NDArray[np.float32],
    floor: NDArray[np.float32],
    nearest: NDArray[np.float32],
) -> None:
    """Add a picture's votes for oyster and sea floor to the cells where its pixels lie.

    A pixel counts 1 / Z², so that one look from near outvotes many from afar, in parts for oyster and for sea floor.

    Args:
        cell: Shape=(H, W), of `locate_pixels`.
        depth: Shape=(H, W), metres along the optical axis.
        likely: Shape=(H, W), probability that a pixel shows an oyster, if it is one or sea floor; nan for no vote.
        oyster: Shape=(FY, FX), votes for oyster, updated in place.
        floor: Shape=(FY, FX), votes for sea floor, updated in place.
        nearest: Shape=(FY, FX), depth of the nearest pixel that voted (m), updated in place.
    """
    nx = oyster.shape[1]
    for v in range(cell.shape[0]):
        for u in range(cell.shape[1]):
            if cell[v, u] == NOWHERE or math.isnan(likely[v, u]):
                continue
            iy, ix = divmod(cell[v, u], nx)
            z = depth[v, u]
            oyster[iy, ix] += likely[v, u] / (z * z)
            floor[iy, ix] += (1.0 - likely[v, u]) / (z * z)
            nearest[iy, ix] = min(nearest[iy, ix], z)
