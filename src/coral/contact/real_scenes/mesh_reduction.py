"""Reduces a mesh to fewer triangles, so that a tracker can draw it hundreds of times."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def reduce_mesh(triangles: Array, most: int) -> Array:
    """Merge the corners that fall into one cell of a grid, on the finest grid that leaves few enough triangles.

    Corners move to the mean of their cell, so that the surface moves by less than the cell's diagonal (Rossignac and
    Borrel, 1993).

    Args:
        triangles: Shape=(M, 3, 3) m.
        most: Largest number of triangles; a mesh with fewer is returned as it is.

    Returns:
        Shape=(N, 3, 3) m, N <= most.
    """
    if len(triangles) <= most:
        return triangles
    extent = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    fine, coarse = 0.0, extent
    best = _clustered(triangles, coarse)
    for _ in range(12):
        cell = (fine + coarse) / 2
        found = _clustered(triangles, cell)
        if 0 < len(found) <= most:
            coarse, best = cell, found
        else:
            fine = cell
    return best


def _clustered(triangles: Array, cell: float) -> Array:
    """Return the triangles whose corners are in three cells."""
    corners = triangles.reshape(-1, 3)
    _, which = np.unique(np.floor(corners / cell).astype(np.int64), axis=0, return_inverse=True)
    which = which.ravel()
    count = np.bincount(which)
    middle = np.column_stack([np.bincount(which, corners[:, axis]) / count for axis in range(3)])
    faces = which.reshape(-1, 3)
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return np.asarray(middle[faces[np.sort(first)]])
