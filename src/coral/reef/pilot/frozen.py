"""A camera that hangs: it delivers the same picture again with new time stamps, while the vehicle moves."""

from __future__ import annotations

import math

from coral.reef.pilot.checks import has_landmarks, same_picture
from coral.reef.vehicle.sensing import Stamped, Velocity
from coral.reef.world.geometry import Frame


class FrozenCamera:
    """Compares each picture with the one before, and adds up the motion while they are equal.

    Motion is that of the measured velocity: a drifting position moves without any motion. Pictures of bare seabed may
    look the same everywhere, so only those that show an oyster or an obstacle count.
    """

    def __init__(self, way_m: float, turn_rad: float) -> None:
        """Set up; equal pictures over more than `way_m` (m) or `turn_rad` (rad) are frozen."""
        self._way_m, self._turn_rad = way_m, turn_rad
        self._last: Stamped[Frame] | None = None
        self._way = self._turn = 0.0

    def update(self, picture: Stamped[Frame], velocity: Velocity) -> bool:
        """Take in the next picture and the present velocity (m/s, m/s, rad/s). Return whether the camera hangs."""
        last, self._last = self._last, picture
        if last is None or not same_picture(last.value, picture.value):
            self._way = self._turn = 0.0
            return False
        dt = max(picture.t - last.t, 0.0)
        self._way += math.hypot(velocity[0], velocity[1]) * dt
        self._turn += abs(velocity[2]) * dt
        return (self._way > self._way_m or self._turn > self._turn_rad) and has_landmarks(picture.value.labels)
