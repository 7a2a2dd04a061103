"""Vertices of a mesh file, as MuJoCo reads it for the simulation, without those of no face."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.foreign_file import read_bytes
from coral.limits import MESH_BYTES

if TYPE_CHECKING:
    from coral.contact.scene.shapes import Shape

EXPECTED = "a binary STL or an OBJ mesh"


def mesh_vertices(part: Shape) -> NDArray[np.float64]:
    """Read the vertices of faces, Shape=(n, 3), of the part's file, scaled, in the part's own frame.

    Raises:
        InputError: The file cannot be read as a mesh.
    """
    vertices, faces = _read(str(part.file), tuple(part.size))
    return vertices[np.unique(faces)]


def add_mesh(spec: mujoco.MjSpec, name: str, part: Shape, scale: NDArray[np.float64]) -> None:
    """Add the part's mesh to a scene, with factors for its axes; MuJoCo's hull would reach to vertices of no face."""
    mesh = spec.add_mesh(name=name)
    mesh.scale = scale
    vertices, faces = _read(str(part.file), (1.0, 1.0, 1.0))
    used, numbered = np.unique(faces, return_inverse=True)
    if len(used) == len(vertices):
        mesh.file = str(part.file)
    else:
        mesh.uservert, mesh.userface = vertices[used].ravel(), numbered.ravel()


@cache
def _read(file: str, scale: tuple[float, float, float]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    spec = mujoco.MjSpec()
    spec.assets = {Path(file).name: read_bytes(Path(file), EXPECTED, MESH_BYTES)}
    mesh = spec.add_mesh(name="part", file=Path(file).name)
    mesh.scale = list(scale)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="part")
    try:
        model = spec.compile()
    except ValueError as error:
        raise InputError(file, "", str(error).splitlines()[0].lower(), EXPECTED) from None
    return placed_vertices(model), np.array(model.mesh_face)


def placed_vertices(model: mujoco.MjModel) -> NDArray[np.float64]:
    """Return the vertices of a model's only mesh, Shape=(n, 3), where its file has them.

    MuJoCo centres a mesh and rotates it to its principal axes.
    """
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.mesh_quat[0])
    return np.asarray(model.mesh_vert.astype(float) @ rotation.reshape(3, 3).T + model.mesh_pos[0])
