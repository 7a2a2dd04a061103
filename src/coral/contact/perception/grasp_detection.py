"""Whether an object is held between the fingers, by what the hand itself feels and where the object is held to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coral.config import NonNegative
from coral.contact.perception.object_model import ObjectModel
from coral.contact.scene.observation import Array


@dataclass(frozen=True, kw_only=True)
class GraspDetectionCfg:
    """When a grip is believed.

    Args:
        squeeze_m: The fingers are told to be closer by so much than they are.
        slack_m: The object's width between the fingers may differ from their distance by so much.
        keep: Factor on the slack, and part of the squeeze, that keep a grip believed once it is.
    """

    squeeze_m: NonNegative = 0.004
    slack_m: NonNegative = 0.008
    keep: NonNegative = 2.0


_PAD_X, _PAD_LOW, _PAD_HIGH = 0.01, -0.044, 0.008
"""m, the pads in the tool's frame: half their breadth, and their ends along the fingers."""


def is_grasped(
    shape: ObjectModel, T_tool_object: Array, opening_m: float, wanted_m: float, before: bool, cfg: GraspDetectionCfg
) -> bool:
    """Whether the fingers, told to close further than they can, have the object between them.

    Args:
        shape: The object.
        T_tool_object: Shape=(4, 4), where it is held to be.
        opening_m: Measured distance between the pads.
        wanted_m: Commanded.
        before: Whether it was so before.
        cfg: The thresholds.
    """
    ease = cfg.keep if before else 1.0
    if opening_m - wanted_m < cfg.squeeze_m / ease:
        return False
    points = shape.points @ T_tool_object[:3, :3].T + T_tool_object[:3, 3]
    reach = 0.005 * (ease - 1.0)
    x, z = np.abs(points[:, 0]), points[:, 2]
    near = points[(x < _PAD_X + reach) & (z > _PAD_LOW) & (z < _PAD_HIGH + reach)]
    if len(near) < 4:
        return False
    low, high = float(near[:, 1].min()), float(near[:, 1].max())
    slack = cfg.slack_m * ease
    return abs(high - opening_m / 2) < slack and abs(low + opening_m / 2) < slack
