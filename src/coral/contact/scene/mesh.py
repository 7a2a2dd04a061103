"""Vertices of a mesh file, as MuJoCo reads it for the simulation."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError

if TYPE_CHECKING:
    from coral.contact.scene.shapes import Shape


def mesh_vertices(part: Shape) -> NDArray[np.float64]:
    """Read the vertices, Shape=(n, 3), of the part's file, scaled, in the part's own frame.

    Raises:
        InputError: The file cannot be read as a mesh.
    """
    return _vertices(str(part.file), tuple(part.size))


@cache
def _vertices(file: str, scale: tuple[float, float, float]) -> NDArray[np.float64]:
    spec = mujoco.MjSpec()
    mesh = spec.add_mesh(name="part", file=file)
    mesh.scale = list(scale)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="part")
    try:
        model = spec.compile()
    except ValueError as error:
        raise InputError(file, "", str(error).splitlines()[0].lower(), "a binary STL or an OBJ mesh") from None
    # MuJoCo centres a mesh and rotates it to its principal axes; undo both.
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.mesh_quat[0])
    return np.asarray(model.mesh_vert.astype(float) @ rotation.reshape(3, 3).T + model.mesh_pos[0])
