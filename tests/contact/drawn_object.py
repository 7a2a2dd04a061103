"""Pictures of one object before a wall, drawn by the ray caster."""

import numpy as np
from solid_object import solid

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.raycast_kernels import render
from coral.contact.scene.geometry import inverse_transform, pose_matrix, rotation_from_vector

LENS = RgbdCameraCfg(width=160, height=120).lens
BOX = solid(("box", (0.06, 0.04, 0.03)))
BOARD = solid(("box", (0.15, 0.1, 0.006)), ("box", (0.05, 0.045, 0.006), (0.2, 0, 0)))
CAN = solid(("cylinder", (0.033, 0.06)))


def picture(model, T, background=1.5):
    """Depth and mask of a model alone before a wall, and the drawing's own depth."""
    back = inverse_transform(T)
    eye, turn = back[:3, 3].copy(), np.ascontiguousarray(back[:3, :3])
    depth, solid, _ = render(turn, eye, LENS, 0.02, 20.0, model.solids, 120, 160)
    return np.where(solid >= 0, depth, background).astype(np.float32), solid >= 0


def tilted(turn=(0.7, 0.4, 0.2), at=(0.02, -0.01, 0.7)):
    """A pose in front of the camera."""
    return pose_matrix(rotation_from_vector(np.array(turn)), np.array(at))
