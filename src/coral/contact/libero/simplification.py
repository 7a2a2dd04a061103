"""Approximation of an object of many boxes by few primitives: each resting box costs four contacts per rollout.

LIBERO approximates a can by about twenty thin boxes. They become one cylinder if it fills the same space, else those
boxes that fill most of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.contact.libero.object_model import Box
from coral.contact.scene.observation import Array
from coral.contact.scene.shapes import Shape

MOST = 4
"""Maximum number of boxes. Twenty rollouts of half a second of the first scene take 63 ms of one core with one box for
each object, 65 ms with up to four, 154 ms with up to twelve."""
COVERED = 0.95
"""Share of the boxes' common volume that the selected boxes must cover."""
ROUND = 0.88
"""Overlap (intersection over union) with the upright cylinder above which an object counts as one."""
GRID = 40
"""Points along each side for comparing volumes."""


def simplified(boxes: Sequence[Box]) -> tuple[Shape, ...]:
    """Return the parts of an object from its boxes, in a frame whose z axis points up."""
    if len(boxes) <= MOST:
        return tuple(map(_as_shape, boxes))
    corners = np.concatenate([box.corners for box in boxes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    steps = (np.arange(GRID) + 0.5) / GRID
    unit = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    inside = np.stack([box.contains(low + unit * (high - low)) for box in boxes])
    filled = inside.any(axis=0)
    cylinder = np.linalg.norm(unit[:, :2] - 0.5, axis=1) <= 0.5
    slim = abs(high[0] - low[0]) - abs(high[1] - low[1])
    overlap = (filled & cylinder).sum() / (filled | cylinder).sum()
    if abs(slim) < 0.005 and overlap >= ROUND:
        diameter = float((high - low)[:2].mean())
        size = (diameter, diameter, float(high[2] - low[2]))
        return (Shape(shape="cylinder", size=size, position=triple((low + high) / 2)),)
    taken: list[int] = []
    while len(taken) < MOST:
        left = filled & ~inside[taken].any(axis=0) if taken else filled
        if left.sum() <= (1 - COVERED) * filled.sum():
            break
        taken.append(int((inside & left).sum(axis=1).argmax()))
    return tuple(_as_shape(boxes[k]) for k in taken)


def _as_shape(box: Box) -> Shape:
    m = box.rotation
    rpy = (np.arctan2(m[2, 1], m[2, 2]), -np.arcsin(np.clip(m[2, 0], -1, 1)), np.arctan2(m[1, 0], m[0, 0]))
    return Shape(size=triple(box.size), position=triple(box.position), rpy_deg=triple(np.degrees(rpy)))


def triple(values: Array) -> tuple[float, float, float]:
    """Round three numbers for a task."""
    x, y, z = (round(float(value), 6) + 0.0 for value in values)
    return x, y, z
