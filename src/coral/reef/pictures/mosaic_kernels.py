"""Hot loop of the orthomosaic: each point of the sea floor takes its colour from the pictures that show it."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def paint(
    coarse: NDArray[np.float32],
    detail: NDArray[np.float32],
    depth: NDArray[np.float32],
    transform: NDArray[np.float64],
    lens: tuple[float, float, float],
    floor_z: float,
    range_m: float,
    near_m: float,
    pixel_m: float,
    best: NDArray[np.float32],
    weight: NDArray[np.float32],
    shade: NDArray[np.float32],
    fine: NDArray[np.float32],
) -> None:
    """Look up the colour of every point in view: detail from the best picture, shade as a mean over all.

    A point is projected into the picture (the inverse of Eq. 1) at the height of the floor. It is visible if the
    pixel's own depth agrees with it within a quarter of its depth: oysters rise a little above the floor, obstacles
    hide it.
    The best picture is the nearest one, with a malus towards the edges of the picture, where pixels are stretched. That
    score, squared, divides the weight of a picture in the mean.

    Args:
        coarse: Shape=(H, W, 3), colours without detail.
        detail: Shape=(H, W, 3), what the picture has besides.
        depth: Shape=(H, W), metres along the optical axis; inf where nothing is seen.
        transform: Shape=(4, 4), camera optical frame to world.
        lens: Focal length and principal point (px).
        floor_z: Height of the floor (m).
        range_m: Largest distance along the line of sight (m).
        near_m: Smallest depth along the optical axis (m).
        pixel_m: Edge of a pixel of the mosaic (m).
        best: Shape=(MY, MX), score of the detail of each point, lower is better; updated in place.
        weight: Shape=(MY, MX), sum of weights; updated in place.
        shade: Shape=(MY, MX, 3), weighted sum of colours without detail; updated in place.
        fine: Shape=(MY, MX, 3), detail; updated in place.
    """
    my, mx = best.shape
    height, width = depth.shape
    focal, cx, cy = lens
    x0, y0, z0 = transform[0, 3], transform[1, 3], transform[2, 3]
    dz = floor_z - z0
    i0 = max(int(math.floor((x0 - range_m) / pixel_m)), 0)
    i1 = min(int(math.floor((x0 + range_m) / pixel_m)) + 1, mx)
    j0 = max(int(math.floor((y0 - range_m) / pixel_m)), 0)
    j1 = min(int(math.floor((y0 + range_m) / pixel_m)) + 1, my)
    for j in range(j0, j1):
        dy = (j + 0.5) * pixel_m - y0
        for i in range(i0, i1):
            dx = (i + 0.5) * pixel_m - x0
            square = dx * dx + dy * dy + dz * dz
            if square > range_m * range_m:
                continue
            z = transform[0, 2] * dx + transform[1, 2] * dy + transform[2, 2] * dz
            if z < near_m:
                continue
            p = (transform[0, 0] * dx + transform[1, 0] * dy + transform[2, 0] * dz) / z
            q = (transform[0, 1] * dx + transform[1, 1] * dy + transform[2, 1] * dz) / z
            u, v = int(math.floor(cx + focal * p + 0.5)), int(math.floor(cy + focal * q + 0.5))
            if u < 0 or v < 0 or u >= width or v >= height or not abs(depth[v, u] - z) < 0.25 * z:
                continue
            score = square * (1.0 + p * p + q * q)
            share = 1.0 / (score * score)
            weight[j, i] += share
            for k in range(3):
                shade[j, i, k] += share * coarse[v, u, k]
            if score < best[j, i]:
                best[j, i] = score
                for k in range(3):
                    fine[j, i, k] = detail[v, u, k]
