"""The depth of a known object at a pose, as a camera would measure it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.raycast_kernels import render
from coral.contact.perception.solids import Solids
from coral.contact.scene.rigid_transform import inverse_transform

Array = NDArray[np.float64]
_NEAR_M, _FAR_M = 0.02, 20.0


def draw_depth(model: ObjectModel, T_camera_object: Array, lens: Array, shape: tuple[int, int]) -> Array:
    """Draw an object alone. Shape=(H, W) m, inf where it is not.

    Args:
        model: The object.
        T_camera_object: Shape=(4, 4).
        lens: Shape=(4,): fx, fy, cx, cy in pixels.
        shape: Height and width of the picture.
    """
    return draw_solids(model.solids, T_camera_object, lens, shape)


def draw_solids(solids: Solids, T_camera_object: Array, lens: Array, shape: tuple[int, int]) -> Array:
    """Draw solids that are placed in an object's frame; see `draw_depth`."""
    back = inverse_transform(T_camera_object)
    depth, solid, face = np.empty(shape), np.empty(shape, np.int64), np.empty(shape, np.int64)
    turn, eye = np.ascontiguousarray(back[:3, :3]), np.ascontiguousarray(back[:3, 3])
    render(turn, eye, lens, _NEAR_M, _FAR_M, solids, depth, solid, face)
    return depth
