"""Detects whether the fingers hold an object, from their distance and the object's estimated pose."""

from __future__ import annotations

import numpy as np

from coral.contact.perception.object_model import ObjectModel
from coral.contact.scene.observation import Array

SQUEEZE_M = 0.004
"""The commanded distance of the fingers is at least this much smaller than the measured one."""
SLACK_M = 0.008
"""Maximum gap between the object and each finger."""
KEEP = 2.0
"""Hysteresis: for a grasp already detected, the slack is multiplied by this and the squeeze divided by it."""
_PAD_X, _PAD_LOW, _PAD_HIGH = 0.01, -0.044, 0.008
"""The pads in the tool's frame (m): half their width, and their ends along the fingers."""


def is_grasped(shape: ObjectModel, T_tool_object: Array, opening_m: float, wanted_m: float, before: bool) -> bool:
    """Decide whether the fingers, commanded to close further than they can, hold the object, as they may have `before`.

    T_tool_object, Shape=(4, 4), is estimated; the openings are the measured and the commanded distance of the pads.
    """
    ease = KEEP if before else 1.0
    if opening_m - wanted_m < SQUEEZE_M / ease:
        return False
    points = shape.points @ T_tool_object[:3, :3].T + T_tool_object[:3, 3]
    reach = 0.005 * (ease - 1.0)
    x, z = np.abs(points[:, 0]), points[:, 2]
    near = points[(x < _PAD_X + reach) & (z > _PAD_LOW) & (z < _PAD_HIGH + reach)]
    if len(near) < 4:
        return False
    low, high = float(near[:, 1].min()), float(near[:, 1].max())
    slack = SLACK_M * ease
    return abs(high - opening_m / 2) < slack and abs(low + opening_m / 2) < slack
