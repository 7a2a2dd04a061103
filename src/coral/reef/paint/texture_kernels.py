"""Sampling of noise tiles, inlined into every kernel that shades a surface."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.paint.noise_tiles import SIZE

FAST = {"contract", "arcp", "afn", "nsz", "reassoc"}
"""Without the flags that let the compiler forget infinity, which is the depth of open water."""
_TEXELS = SIZE * SIZE


@njit(cache=True, error_model="numpy", fastmath=FAST)
def sample_tile(
    tile: NDArray[np.uint8], x: float, y: float, period: float, span: float
) -> tuple[float, float, float, float]:
    """Sample a tile of edge `period` (m) for a pixel that covers `span` (m): bilinear, on the level nearest to it."""
    wide = span * SIZE / period
    level = 0
    while wide > 1.414 and level < 9:
        wide *= 0.5
        level += 1
    n = SIZE >> level
    start = (4 * _TEXELS - 4 * n * n) // 3
    a, b = x / period * n, y / period * n
    fa, fb = math.floor(a), math.floor(b)
    j, i = int(fa), int(fb)
    a, b = a - fa, b - fb
    i0, i1, j0, j1 = (i & (n - 1)) * n, ((i + 1) & (n - 1)) * n, j & (n - 1), (j + 1) & (n - 1)
    k00, k01, k10, k11 = start + i0 + j0, start + i0 + j1, start + i1 + j0, start + i1 + j1
    unit = 1.0 / 255.0
    w00, w01 = unit * (1.0 - a) * (1.0 - b), unit * a * (1.0 - b)
    w10, w11 = unit * (1.0 - a) * b, unit * a * b
    return (
        w00 * tile[k00, 0] + w01 * tile[k01, 0] + w10 * tile[k10, 0] + w11 * tile[k11, 0],
        w00 * tile[k00, 1] + w01 * tile[k01, 1] + w10 * tile[k10, 1] + w11 * tile[k11, 1],
        w00 * tile[k00, 2] + w01 * tile[k01, 2] + w10 * tile[k10, 2] + w11 * tile[k11, 2],
        w00 * tile[k00, 3] + w01 * tile[k01, 3] + w10 * tile[k10, 3] + w11 * tile[k11, 3],
    )


@njit(cache=True, error_model="numpy", fastmath=FAST)
def smooth_step(low: float, high: float, x: float) -> float:
    """Rise smoothly from 0 at `low` to 1 at `high`."""
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)
