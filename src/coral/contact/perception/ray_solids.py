"""Conversion of geoms of a MuJoCo model to `Solids`."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import solids as kinds
from coral.contact.perception.solids import Solids
from coral.errors import InputError

Array = NDArray[np.float64]
_DRAWN = (kinds.PLANE, kinds.SPHERE, kinds.CAPSULE, kinds.ELLIPSOID, kinds.CYLINDER, kinds.BOX, kinds.MESH)


def from_mujoco(model: mujoco.MjModel, geoms: NDArray[np.int64]) -> Solids:
    """Convert some geoms; `center` and `rotation` stay zero: they change over time.

    Raises:
        InputError: A geom is a height field or a signed distance field.
    """
    kind = model.geom_type[geoms].astype(np.int64)
    for i, k in zip(geoms, kind, strict=True):
        if k not in _DRAWN:
            raise InputError(
                "scene",
                model.geom(i).name or f"geom {i}",
                f"geom type {k}",
                "a plane, primitive or mesh (the ray caster draws no height fields)",
            )
    size = model.geom_size[geoms].astype(float)
    first, count = np.zeros(len(geoms), np.int64), np.zeros(len(geoms), np.int64)
    corners: list[Array] = []
    begin: dict[int, int] = {}
    total = 0
    for row, i in enumerate(geoms):
        if kind[row] == kinds.MESH:
            mesh = int(model.geom_dataid[i])
            start, number = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
            if mesh not in begin:
                vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
                corners.append(vertices[model.mesh_face[start : start + number]].astype(float))
                begin[mesh] = total
                total += number
            first[row], count[row] = begin[mesh], number
            size[row] = np.abs(model.geom_aabb[i, :3]) + model.geom_aabb[i, 3:]
    n = len(geoms)
    return Solids(
        kind,
        np.zeros((n, 3)),
        np.zeros((n, 3, 3)),
        size,
        first,
        count,
        np.concatenate(corners) if corners else np.zeros((0, 3, 3)),
    )
