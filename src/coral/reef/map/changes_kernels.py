"""Comparison of a mask with its copy (numba)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def take_changes(kept: NDArray[np.bool_], now: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Bring a copy of a mask up to date. Return the rectangle (y0, y1, x0, x1) of the cells that differed.

    Args:
        kept: Shape=(NY, NX), the copy, updated in place.
        now: Shape=(NY, NX), the mask.
    """
    ny, nx = now.shape
    y0, y1, x0, x1 = ny, 0, nx, 0
    for y in range(ny):
        differs = False
        for x in range(nx):  # without a branch, so that it is done many cells at a time
            differs |= kept[y, x] != now[y, x]
        if not differs:
            continue
        y0, y1 = min(y0, y), y + 1
        for x in range(nx):
            if kept[y, x] != now[y, x]:
                kept[y, x] = now[y, x]
                x0, x1 = min(x0, x), max(x1, x + 1)
    return y0, y1, x0, x1
