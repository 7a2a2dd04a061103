"""Which pixels show the hand: an arm reports where it is, and its shape is known."""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from coral.contact.control.hand_model import HandCfg, add_hand
from coral.contact.perception.camera import RgbdFrame, draw_depth
from coral.contact.perception.image_patch import ROBOT_NAME
from coral.contact.perception.solids import from_mujoco
from coral.contact.scene.geometry import inverse_transform
from coral.contact.scene.observation import Array

MARGIN_M = 0.02
"""Measured depths this near to the drawn hand are the hand's: a camera's calibration and delay err by some of it."""
SWELL_M = 0.003
"""By so much the hand is drawn larger on each side, for the same reason."""


@dataclass(frozen=True)
class HandReading:
    """What an arm reports of its hand at the time of a picture."""

    T_world_tool: Array
    """Shape=(4, 4)."""
    opening_m: float
    """Measured distance of the fingers."""
    wanted_m: float
    """Commanded distance."""


class HandMask:
    """Labels the pixels of the hand in pictures. The arm's links are not labelled."""

    def __init__(self) -> None:
        spec = mujoco.MjSpec()
        add_hand(spec, HandCfg())
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        tool = data.site("tool").xpos
        self._solids = from_mujoco(model, np.arange(model.ngeom))
        self._solids.size[self._solids.size > 0.0] += SWELL_M
        self._solids.center[:] = data.geom_xpos - tool
        self._solids.rotation[:] = data.geom_xmat.reshape(-1, 3, 3)
        sides = {"left": 1.0, "right": -1.0}
        self._way = np.array([sides.get(model.body(int(body)).name, 0.0) for body in model.geom_bodyid])
        self._closed = self._solids.center[:, 1].copy()

    def label(self, frame: RgbdFrame, hand: HandReading) -> RgbdFrame:
        """Return the picture with the hand's pixels labelled as the robot's: drawn there, and nothing is nearer."""
        self._solids.center[:, 1] = self._closed + self._way * hand.opening_m / 2
        placed = inverse_transform(frame.T_world_camera) @ hand.T_world_tool
        drawn = draw_depth(self._solids, placed, frame)
        shown = np.isfinite(drawn) & ((frame.depth == 0.0) | (np.abs(frame.depth - drawn) < MARGIN_M))
        names = (*frame.names, ROBOT_NAME) if ROBOT_NAME not in frame.names else frame.names
        instance = np.where(shown & (frame.instance == 0), names.index(ROBOT_NAME) + 1, frame.instance)
        return replace(frame, names=names, instance=instance.astype(np.uint8))
