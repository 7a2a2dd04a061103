"""Disturbance of perfect depth and instances by given random numbers, as in a real camera."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, error_model="numpy")
def disturb(
    depth: NDArray[np.float64],
    normal: NDArray[np.float64],
    instance: NDArray[np.uint8],
    lens: NDArray[np.float64],
    lateral: NDArray[np.float32],
    wavy: NDArray[np.float32],
    axial: NDArray[np.float32],
    uneven: NDArray[np.float32],
    chance: NDArray[np.float32],
    amounts: NDArray[np.float64],
    measured: NDArray[np.float64],
    labels: NDArray[np.uint8],
) -> None:
    """Disturb a picture, Shape=(H, W): write what is `measured` (m; inf: nothing), and the instances (`labels`).

    Depth is in metres, inf without a surface; unit normals are in the camera frame; the lens is fx, fy, cx, cy in
    pixels. The randomness is unit normal, independent (`lateral`, Shape=(2, H, W), and `axial`) or shared by neighbours
    (`wavy`, Shape=(2, H, W), and `uneven`), or uniform from 0 to 1 (`chance`). `amounts`, Shape=(10,): lateral
    (pixels), wavy (pixels), axial (m) and its growth (1/m), uneven (m), disparity constant (m: depth times steps of
    disparity; 0 for no steps), least cosine to the ray, share of holes at edges and elsewhere, jump (m).
    """
    height, width = depth.shape
    jump = amounts[9]
    for v in range(height):
        q = (v - lens[3]) / lens[1]
        for u in range(width):
            row = v + int(round(amounts[0] * lateral[0, v, u] + amounts[1] * wavy[0, v, u]))
            column = u + int(round(amounts[0] * lateral[1, v, u] + amounts[1] * wavy[1, v, u]))
            row, column = min(max(row, 0), height - 1), min(max(column, 0), width - 1)
            labels[v, u] = instance[row, column]
            measured[v, u] = np.inf
            here, there = min(depth[v, u], 99.0), min(depth[row, column], 99.0)
            edge = abs(there - here) > jump
            # A shifted pixel that stays on the same surface keeps its own depth: only outlines are jagged.
            z = there if edge else here
            if u > 0:
                edge = edge or abs(min(depth[v, u - 1], 99.0) - here) > jump
            if v > 0:
                edge = edge or abs(min(depth[v - 1, u], 99.0) - here) > jump
            if z > 98.0 or chance[v, u] < (amounts[7] if edge else amounts[8]):
                continue
            p = (u - lens[2]) / lens[0]
            facing = -(normal[v, u, 0] * p + normal[v, u, 1] * q + normal[v, u, 2]) / math.sqrt(1.0 + p * p + q * q)
            if facing < amounts[6]:
                continue
            tilt = min(math.acos(min(facing, 1.0)), 1.5)
            slant = tilt / (0.5 * math.pi - tilt)
            spread = amounts[2] + amounts[3] * (z - 0.4) ** 2 + 1e-4 / math.sqrt(z) * slant * slant
            z += min(spread, 0.05) * axial[v, u] + amounts[4] * z * z * uneven[v, u]
            if amounts[5] > 0.0:
                z = amounts[5] / max(1.0, round(amounts[5] / max(z, 0.05)))
            measured[v, u] = z
