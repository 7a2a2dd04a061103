"""Where a mask has changed since it was last looked at, so that what follows from it is renewed only there."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Box = tuple[int, int, int, int]
"""Rows and columns of a rectangle of cells: (y0, y1, x0, x1), the ends excluded."""


class ChangeTracker:
    """Compares a mask with a copy of it, and so notices whoever writes to it."""

    def __init__(self, mask: NDArray[np.bool_]) -> None:
        self._mask, self._kept = mask, np.zeros_like(mask)

    def take(self) -> Box | None:
        """Return the smallest rectangle of all changes since the last call, at first since all False; None: none."""
        rows = np.flatnonzero((self._kept != self._mask).any(axis=1))
        if not rows.size:
            return None
        y0, y1 = int(rows[0]), int(rows[-1]) + 1
        columns = np.flatnonzero((self._kept[y0:y1] != self._mask[y0:y1]).any(axis=0))
        self._kept[y0:y1] = self._mask[y0:y1]
        return y0, y1, int(columns[0]), int(columns[-1]) + 1


def around(x: float, y: float, radius_m: float, cell_m: float, shape: tuple[int, int]) -> Box:
    """Return the rectangle of cells within a radius (m) of a point, clipped to a grid of `shape`; empty beyond it."""
    r, iy, ix = math.ceil(radius_m / cell_m) + 1, int(y // cell_m), int(x // cell_m)
    y0, x0 = min(max(iy - r, 0), shape[0]), min(max(ix - r, 0), shape[1])
    return y0, max(min(iy + r + 1, shape[0]), y0), x0, max(min(ix + r + 1, shape[1]), x0)


def grown(box: Box, cells: int, shape: tuple[int, int]) -> Box:
    """Return a rectangle with a rim of this many cells, clipped to a grid of `shape`."""
    y0, y1, x0, x1 = box
    return max(y0 - cells, 0), min(y1 + cells, shape[0]), max(x0 - cells, 0), min(x1 + cells, shape[1])


def joined(a: Box, b: Box) -> Box:
    """Return the smallest rectangle that contains both."""
    return min(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), max(a[3], b[3])


def meet(a: Box, b: Box) -> bool:
    """Check whether two rectangles share a cell."""
    return a[0] < b[1] and b[0] < a[1] and a[2] < b[3] and b[2] < a[3]
