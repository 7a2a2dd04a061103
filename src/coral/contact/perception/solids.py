"""Solids that a ray can hit, as one value that the ray-casting kernels take."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PLANE, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = 0, 2, 3, 4, 5, 6, 7
"""`Solids.kind`, with MuJoCo's numbers (mjtGeom)."""


class Solids(NamedTuple):
    """N solids in one frame."""

    kind: NDArray[np.int64]
    """Shape=(N,), a mjtGeom."""
    center: Array
    """Shape=(N, 3) m."""
    rotation: Array
    """Shape=(N, 3, 3), solid to frame."""
    size: Array
    """Shape=(N, 3) m, as MuJoCo's geom_size; for a mesh, half the extents of a box about its origin."""
    first_triangle: NDArray[np.int64]
    """Shape=(N,), where a mesh begins in `triangles`."""
    triangle_count: NDArray[np.int64]
    """Shape=(N,), of a mesh; 0 for a primitive."""
    triangles: Array
    """Shape=(M, 3, 3) m, corners in the frame of their solid."""
