"""Hot loop of the map alignment: the score of many poses of one map on another."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def score_poses(
    poses: NDArray[np.float64],
    points: NDArray[np.float64],
    kinds: NDArray[np.int64],
    pivot: tuple[float, float],
    fields: NDArray[np.float32],
    cell_m: float,
    scores: NDArray[np.float64],
) -> None:
    """Add up the score of every point under every pose.

    Args:
        poses: Shift along x and y (m) and turn (rad) about the pivot. Shape=(K, 3).
        points: Places on the map that is turned and shifted (m). Shape=(N, 2).
        kinds: Kind of each point, an index into `fields`. Shape=(N,).
        pivot: Place about which the map is turned (m).
        fields: Score of a point of each kind in each cell of the map that stays. Shape=(KINDS, NY, NX).
        cell_m: Edge of a cell (m).
        scores: Result; points outside the map count 0. Shape=(K,).
    """
    ny, nx = fields.shape[1:]
    for k in range(len(poses)):
        c, s = math.cos(poses[k, 2]), math.sin(poses[k, 2])
        x0, y0 = pivot[0] + poses[k, 0], pivot[1] + poses[k, 1]
        total = 0.0
        for i in range(len(points)):
            x, y = points[i, 0] - pivot[0], points[i, 1] - pivot[1]
            ix = int(math.floor((x0 + c * x - s * y) / cell_m))
            iy = int(math.floor((y0 + s * x + c * y) / cell_m))
            if 0 <= ix < nx and 0 <= iy < ny:
                total += fields[kinds[i], iy, ix]
        scores[k] = total
