"""One object that a camera watches: its tracker, and its motion in the world or in the hand that holds it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coral.contact.perception.motion_filter import MotionFilter, MotionFilterCfg
from coral.contact.perception.tracker import PoseTracker
from coral.contact.scene.observation import Array
from coral.contact.scene.rigid_transform import inverse_transform

_IN_HAND_GAIN = 0.3


class TrackedObject:
    """One object: its tracker, and its motion in the world or, held between the fingers, in the hand."""

    def __init__(self, tracker: PoseTracker, cfg: MotionFilterCfg) -> None:
        self.tracker, self._cfg = tracker, cfg
        # Squeezed between rubber pads it moves with them: what pictures say otherwise is mostly noise.
        self.in_hand = replace(cfg, position_gain=_IN_HAND_GAIN, velocity_gain=0.0)
        self.held = False
        self.lost_since: float | None = None
        self.motion: MotionFilter | None = None

    def hold(self, held: bool, tool: Array, time_s: float) -> None:
        """Whether it now moves with the hand."""
        if held != self.held:
            before, after = (np.eye(4), inverse_transform(tool)) if held else (tool, np.eye(4))
            T = after @ before @ self.known.at(time_s)
            self.motion, self.held = MotionFilter(self.in_hand if held else self._cfg, T, time_s), held

    @property
    def known(self) -> MotionFilter:
        """Its motion, once it has been found."""
        assert self.motion is not None
        return self.motion

    def at(self, tool: Array, time_s: float) -> Array:
        """T_world_object."""
        found = self.known.at(time_s)
        return tool @ found if self.held else found
