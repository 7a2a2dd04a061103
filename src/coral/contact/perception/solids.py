"""Solids for ray casting, as one value for the kernels, from the geoms of a MuJoCo model."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.observation import Array
from coral.errors import InputError

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


def from_mujoco(model: mujoco.MjModel, geoms: NDArray[np.int64]) -> Solids:
    """Convert some geoms; `center` and `rotation` stay zero: they change over time.

    Raises:
        InputError: A geom is a height field or a signed distance field.
    """
    kind = model.geom_type[geoms].astype(np.int64)
    for i, k in zip(geoms, kind, strict=True):
        if k not in (PLANE, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH):
            expected = "a plane, primitive or mesh (the ray caster draws no height fields)"
            raise InputError("scene", model.geom(i).name or f"geom {i}", f"geom type {k}", expected)
    size = model.geom_size[geoms].astype(float)
    first, count = np.zeros(len(geoms), np.int64), np.zeros(len(geoms), np.int64)
    corners: list[Array] = []
    begin: dict[int, int] = {}
    total = 0
    for row, i in enumerate(geoms):
        if kind[row] == MESH:
            mesh = int(model.geom_dataid[i])
            start, number = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
            if mesh not in begin:
                vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
                corners.append(vertices[model.mesh_face[start : start + number]].astype(float))
                begin[mesh] = total
                total += number
            first[row], count[row] = begin[mesh], number
            size[row] = np.abs(model.geom_aabb[i, :3]) + model.geom_aabb[i, 3:]
    n, triangles = len(geoms), np.concatenate(corners) if corners else np.zeros((0, 3, 3))
    return Solids(kind, np.zeros((n, 3)), np.zeros((n, 3, 3)), size, first, count, triangles)
