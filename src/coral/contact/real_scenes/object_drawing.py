"""The depth of a known object at a pose, as a camera would measure it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.raycast_kernels import render
from coral.contact.perception.solids import Solids
from coral.contact.scene.rigid_transform import inverse_transform

Array = NDArray[np.float64]
_NEAR_M, _FAR_M = 0.02, 20.0


def draw_depth(solids: Solids, T_camera_object: Array, frame: RgbdFrame) -> Array:
    """Draw an object alone, as a camera's picture would show it. Shape=(H, W) m, inf where it is not.

    Args:
        solids: The object, in its own frame.
        T_camera_object: Shape=(4, 4).
        frame: A picture of that camera.
    """
    shape = frame.depth.shape
    back = inverse_transform(T_camera_object)
    depth, solid, face = np.empty(shape), np.empty(shape, np.int64), np.empty(shape, np.int64)
    turn, eye = np.ascontiguousarray(back[:3, :3]), np.ascontiguousarray(back[:3, 3])
    render(turn, eye, frame.lens, _NEAR_M, _FAR_M, solids, depth, solid, face)
    return depth
