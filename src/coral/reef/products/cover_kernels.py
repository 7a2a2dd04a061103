"""Hot loops of the products: which class pictures show at each point of the sea floor, from how near and how often."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

OYSTER = 1
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


@njit(cache=True)
def look(
    cell: NDArray[np.int64],
    away: NDArray[np.float64],
    labels: NDArray[np.uint8],
    nearest: NDArray[np.float32],
    looks: NDArray[np.uint16],
    last: NDArray[np.int32],
    picture: int,
) -> None:
    """Note from how near each cell was seen, and in how many pictures.

    Args:
        cell: Shape=(H, W), of `locate_pixels`.
        away: Shape=(H, W), of `locate_pixels`.
        labels: Shape=(H, W), pixel classes.
        nearest: Shape=(NY, NX), smallest distance along the line of sight (m), updated in place.
        looks: Shape=(NY, NX), pictures that show the cell, updated in place.
        last: Shape=(NY, NX), last picture that counted for each cell, updated in place.
        picture: Number of this picture, 1 or more.
    """
    nx = nearest.shape[1]
    for v in range(cell.shape[0]):
        for u in range(cell.shape[1]):
            if cell[v, u] == NOWHERE or labels[v, u] == 0:
                continue
            iy, ix = divmod(cell[v, u], nx)
            nearest[iy, ix] = min(nearest[iy, ix], away[v, u])
            if last[iy, ix] != picture:
                last[iy, ix] = picture
                looks[iy, ix] = min(looks[iy, ix] + 1, 65535)


@njit(cache=True)
def count_in_groups(
    cell: NDArray[np.int64],
    labels: NDArray[np.uint8],
    group: NDArray[np.int32],
    border: int,
    counts: NDArray[np.int64],
) -> None:
    """Count a picture's oyster pixels in each cluster, without those at the picture's border.

    Args:
        cell: Shape=(H, W), of `locate_pixels`.
        labels: Shape=(H, W), pixel classes.
        group: Shape=(NY, NX), number of the cluster of each cell, 0 for none.
        border: Width of the border (px).
        counts: Shape=(N + 1,), pixels of each cluster, updated in place.
    """
    nx = group.shape[1]
    for v in range(border, cell.shape[0] - border):
        for u in range(border, cell.shape[1] - border):
            if cell[v, u] != NOWHERE and labels[v, u] == OYSTER:
                iy, ix = divmod(cell[v, u], nx)
                counts[group[iy, ix]] += 1
