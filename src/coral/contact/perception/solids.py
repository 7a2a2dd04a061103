"""Solids for ray casting, as one value for the kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PLANE, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = 0, 2, 3, 4, 5, 6, 7
"""Values of `Solids.kind`, with MuJoCo's numbers (mjtGeom)."""


class Solids(NamedTuple):
    """N solids in one frame."""

    kind: NDArray[np.int64]
    """Kind, Shape=(N,), an mjtGeom."""
    center: Array
    """Shape=(N, 3) m."""
    rotation: Array
    """Shape=(N, 3, 3), solid to frame."""
    size: Array
    """Size, Shape=(N, 3) m, as MuJoCo's geom_size; for a mesh, half the extents of a box about its origin."""
    first_triangle: NDArray[np.int64]
    """First triangle of a mesh in `triangles`, Shape=(N,)."""
    triangle_count: NDArray[np.int64]
    """Number of triangles of a mesh, Shape=(N,); 0 for a primitive."""
    triangles: Array
    """Corners of the triangles in the frame of their solid, Shape=(M, 3, 3) m."""
