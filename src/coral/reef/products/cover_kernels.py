"""Hot loops of the products: which class pictures show at each point of the sea floor, from how near and how often."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

OYSTER, OBSTACLE, SEABED = 1, 2, 3


@njit(cache=True)
def vote(
    depth: NDArray[np.float32],
    labels: NDArray[np.uint8],
    transform: NDArray[np.float64],
    lens: tuple[float, float, float],
    range_m: float,
    fine_m: float,
    oyster: NDArray[np.float32],
    floor: NDArray[np.float32],
) -> None:
    """Add a picture's votes for oyster and sea floor to the points where its pixels lie.

    A pixel counts 1 / Z², so that one look from near outvotes many from afar.

    Args:
        depth: Shape=(H, W), metres along the optical axis; inf where nothing is seen.
        labels: Shape=(H, W), pixel classes.
        transform: Shape=(4, 4), camera optical frame to world.
        lens: Focal length and principal point (px).
        range_m: Largest distance along the line of sight (m).
        fine_m: Edge of a point's cell (m).
        oyster: Shape=(FY, FX), votes for oyster, updated in place.
        floor: Shape=(FY, FX), votes for sea floor, updated in place.
    """
    ny, nx = oyster.shape
    height, width = depth.shape
    focal, cx, cy = lens
    for v in range(height):
        q = (v - cy) / focal
        for u in range(width):
            z = depth[v, u]
            label = labels[v, u]
            if not z < np.inf or (label != OYSTER and label != SEABED):
                continue
            p = (u - cx) / focal
            if z * math.sqrt(1.0 + p * p + q * q) > range_m:
                continue
            x = transform[0, 3] + z * (transform[0, 0] * p + transform[0, 1] * q + transform[0, 2])
            y = transform[1, 3] + z * (transform[1, 0] * p + transform[1, 1] * q + transform[1, 2])
            ix, iy = int(math.floor(x / fine_m)), int(math.floor(y / fine_m))
            if ix < 0 or iy < 0 or ix >= nx or iy >= ny:
                continue
            if label == OYSTER:
                oyster[iy, ix] += 1.0 / (z * z)
            else:
                floor[iy, ix] += 1.0 / (z * z)


@njit(cache=True)
def look(
    depth: NDArray[np.float32],
    labels: NDArray[np.uint8],
    transform: NDArray[np.float64],
    lens: tuple[float, float, float],
    range_m: float,
    cell_m: float,
    nearest: NDArray[np.float32],
    looks: NDArray[np.uint16],
    last: NDArray[np.int32],
    picture: int,
) -> None:
    """Note from how near each cell was seen, and in how many pictures.

    Args:
        depth: As for `vote`, as are labels, transform and lens.
        labels: See depth.
        transform: See depth.
        lens: See depth.
        range_m: Largest distance along the line of sight (m).
        cell_m: Edge of a cell (m).
        nearest: Shape=(NY, NX), smallest distance along the line of sight (m), updated in place.
        looks: Shape=(NY, NX), pictures that show the cell, updated in place.
        last: Shape=(NY, NX), last picture that counted for each cell, updated in place.
        picture: Number of this picture, from 1 on.
    """
    ny, nx = nearest.shape
    height, width = depth.shape
    focal, cx, cy = lens
    for v in range(height):
        q = (v - cy) / focal
        for u in range(width):
            z = depth[v, u]
            if not z < np.inf or labels[v, u] == 0:
                continue
            p = (u - cx) / focal
            away = z * math.sqrt(1.0 + p * p + q * q)
            if away > range_m:
                continue
            x = transform[0, 3] + z * (transform[0, 0] * p + transform[0, 1] * q + transform[0, 2])
            y = transform[1, 3] + z * (transform[1, 0] * p + transform[1, 1] * q + transform[1, 2])
            ix, iy = int(math.floor(x / cell_m)), int(math.floor(y / cell_m))
            if ix < 0 or iy < 0 or ix >= nx or iy >= ny:
                continue
            nearest[iy, ix] = min(nearest[iy, ix], away)
            if last[iy, ix] != picture:
                last[iy, ix] = picture
                looks[iy, ix] = min(looks[iy, ix] + 1, 65535)


@njit(cache=True)
def count_in_groups(
    depth: NDArray[np.float32],
    labels: NDArray[np.uint8],
    transform: NDArray[np.float64],
    lens: tuple[float, float, float],
    cell_m: float,
    group: NDArray[np.int32],
    border: int,
    counts: NDArray[np.int64],
) -> None:
    """Count a picture's oyster pixels in each cluster, without those at the picture's border.

    Args:
        depth: As for `vote`, as are labels, transform and lens.
        labels: See depth.
        transform: See depth.
        lens: See depth.
        cell_m: Edge of a cell (m).
        group: Shape=(NY, NX), number of the cluster of each cell, 0 for none.
        border: Width of the border (px).
        counts: Shape=(N + 1,), pixels of each cluster, updated in place.
    """
    ny, nx = group.shape
    height, width = depth.shape
    focal, cx, cy = lens
    for v in range(border, height - border):
        q = (v - cy) / focal
        for u in range(border, width - border):
            z = depth[v, u]
            if not z < np.inf or labels[v, u] != OYSTER:
                continue
            p = (u - cx) / focal
            x = transform[0, 3] + z * (transform[0, 0] * p + transform[0, 1] * q + transform[0, 2])
            y = transform[1, 3] + z * (transform[1, 0] * p + transform[1, 1] * q + transform[1, 2])
            ix, iy = int(math.floor(x / cell_m)), int(math.floor(y / cell_m))
            if ix >= 0 and iy >= 0 and ix < nx and iy < ny:
                counts[group[iy, ix]] += 1
