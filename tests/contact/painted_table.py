"""Pictures of one painted box on a table, seen from above at an angle."""

import numpy as np
from solid_object import solid

from coral.contact.perception.camera import RgbdFrame, draw_depth, look_at
from coral.contact.scene.geometry import inverse_transform, pose_matrix

LENS = np.array([120.0, 120.0, 47.5, 35.5])
SHAPE = (72, 96)
PLACED = look_at((-0.4, 0.0, 0.4), (0.0, 0.0, 0.03))
BOX = solid(("box", (0.04, 0.03, 0.03)))
TABLE = solid(("box", (0.4, 0.4, 0.05)))
EMPTY = RgbdFrame(np.zeros(SHAPE, np.float32), np.zeros(SHAPE, np.uint8), (), LENS, PLACED)
PAINT, WOOD = (200, 60, 40), (210, 200, 185)


def at(x, y):
    return pose_matrix(np.eye(3), [x, y, 0.03])


def picture(*boxes, paints=(PAINT, PAINT), colours=True):
    """Return a picture of boxes at T_world_object, and the true mask of each."""
    camera = inverse_transform(PLACED)
    depth = draw_depth(TABLE.solids, camera @ pose_matrix(np.eye(3), [0, 0, -0.05]), EMPTY)
    rgb = np.full((*SHAPE, 3), 90, np.uint8)
    rgb[np.isfinite(depth)] = WOOD
    masks = []
    for box, paint in zip(boxes, paints, strict=False):
        drawn = draw_depth(BOX.solids, camera @ box, EMPTY)
        masks.append(drawn < depth)
        rgb[masks[-1]] = paint
        depth = np.minimum(depth, drawn)
    measured = np.where(np.isfinite(depth), depth, 0.0).astype(np.float32)
    nothing = np.zeros(SHAPE, np.uint8)
    return RgbdFrame(measured, nothing, (), LENS, PLACED, 0.0, rgb if colours else None), masks


def overlap(mask, truth):
    return (mask & truth).sum() / (mask | truth).sum()
