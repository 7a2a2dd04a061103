"""The depth of a known object at a pose, as a camera would measure it."""

from __future__ import annotations

import numpy as np

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.raycast_kernels import FAR_M, NEAR_M, invert, render
from coral.contact.perception.solids import Solids
from coral.contact.scene.observation import Array


def draw_depth(solids: Solids, T_camera_object: Array, frame: RgbdFrame) -> Array:
    """Draw an object, in its own frame, alone, as a frame's camera would: Shape=(H, W) m, inf where it is not."""
    shape, turn, eye = frame.depth.shape, np.empty((3, 3)), np.empty(3)
    depth, solid, face = np.empty(shape), np.empty(shape, np.int64), np.empty(shape, np.int64)
    invert(T_camera_object, turn, eye)
    render(turn, eye, frame.lens, NEAR_M, FAR_M, solids, depth, solid, face)
    return depth
