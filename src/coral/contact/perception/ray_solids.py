"""Conversion of primitive parts and geoms of a MuJoCo model to `Solids`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import solids as kinds
from coral.contact.perception.solids import Solids
from coral.errors import InputError

Array = NDArray[np.float64]
KINDS = {
    "box": kinds.BOX,
    "cylinder": kinds.CYLINDER,
    "capsule": kinds.CAPSULE,
    "sphere": kinds.SPHERE,
    "ellipsoid": kinds.ELLIPSOID,
}
_DRAWN = (kinds.PLANE, kinds.MESH, *KINDS.values())


@dataclass(frozen=True)
class SolidPart:
    """A primitive part of an object."""

    kind: str
    """"box", "cylinder", "capsule", "sphere" or "ellipsoid"."""
    size: tuple[float, ...]
    """Same as MuJoCo's geom size: half extents; radius and half length; radius; semi-axes (m)."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Position in the object's frame, Shape=(3,) m."""
    rotation: Array = field(default_factory=lambda: np.eye(3))
    """Rotation, part to object, Shape=(3, 3)."""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError("object", "kind", self.kind, f"one of {', '.join(KINDS)}")
        wanted = {"sphere": 1, "cylinder": 2, "capsule": 2}.get(self.kind, 3)
        if len(self.size) < wanted or not all(0.0 < s < 10.0 for s in self.size[:wanted]):
            raise InputError("object", "size", self.size, f"{wanted} half extents between 0 and 10 m for a {self.kind}")


def from_parts(parts: Iterable[SolidPart]) -> Solids:
    """Convert primitives, in their object's frame."""
    parts = tuple(parts)
    if not parts:
        raise InputError("object", "parts", "none", "at least one part")
    size = np.array([(*p.size, 0.0, 0.0)[:3] for p in parts], float)
    nothing = np.zeros(len(parts), np.int64)
    return Solids(
        np.array([KINDS[p.kind] for p in parts], np.int64),
        np.array([p.position for p in parts], float),
        np.array([p.rotation for p in parts], float),
        size,
        nothing,
        nothing,
        np.zeros((0, 3, 3)),
    )


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
