"""One tracked object: its tracker, and its motion in the world or in the hand that holds it."""

from __future__ import annotations

import numpy as np

from coral.contact.perception.motion_filter import MotionFilter, MotionFilterCfg
from coral.contact.perception.tracker import PoseTracker
from coral.contact.scene.observation import Array
from coral.contact.scene.rigid_transform import inverse_transform

_IN_HAND = MotionFilterCfg(position_gain=0.3, velocity_gain=0.0)
"""Squeezed between rubber pads an object moves with them; any other motion in the pictures is mostly noise."""


class TrackedObject:
    """Tracks one object in the frame in which it rests: the world's, or the hand's while the fingers hold it.

    Args:
        tracker: Estimates its pose in pictures.
    """

    def __init__(self, tracker: PoseTracker) -> None:
        self.tracker = tracker
        self.held = False
        self.lost_since: float | None = None
        self.motion: MotionFilter | None = None

    def hold(self, held: bool, tool: Array, time_s: float) -> None:
        """Change to the hand's frame (`held`) or back to the world's.

        Args:
            held: Whether the object now moves with the hand.
            tool: T_world_tool, Shape=(4, 4).
            time_s: Present time.
        """
        if held != self.held:
            before, after = (np.eye(4), inverse_transform(tool)) if held else (tool, np.eye(4))
            T = after @ before @ self.known.predict(time_s)
            self.held = held
            self.begin(T, time_s)

    def begin(self, T: Array, time_s: float) -> None:
        """Begin its motion anew at a pose, Shape=(4, 4), in the frame in which it rests."""
        self.motion = MotionFilter(_IN_HAND if self.held else MotionFilterCfg(), T, time_s)

    @property
    def known(self) -> MotionFilter:
        """Return its motion; only after it has been found."""
        assert self.motion is not None
        return self.motion

    def at(self, tool: Array, time_s: float) -> Array:
        """Return T_world_object at a time, Shape=(4, 4), with the hand at T_world_tool."""
        found = self.known.predict(time_s)
        return tool @ found if self.held else found
