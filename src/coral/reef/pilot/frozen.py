"""A sensor that hangs: it delivers the same again with new time stamps, while the vehicle moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Generic, TypeVar

from coral.reef.vehicle.sensing import Stamped, Velocity

T = TypeVar("T")


class FrozenSensor(Generic[T]):
    """Compares each measurement with the one before, and adds up the motion while they are equal.

    Motion is that of the measured velocity: a drifting position moves without any motion.
    """

    def __init__(self, same: Callable[[T, T], bool], way_m: float, turn_rad: float = math.inf) -> None:
        """Set up; what is the same over more than `way_m` (m) or `turn_rad` (rad) is frozen."""
        self._same, self._way_m, self._turn_rad = same, way_m, turn_rad
        self._last: Stamped[T] | None = None
        self._way = self._turn = 0.0

    def update(self, new: Stamped[T], velocity: Velocity) -> bool:
        """Take in the next measurement and the present velocity (m/s, m/s, rad/s). Return whether the sensor hangs."""
        last, self._last = self._last, new
        if last is None or not self._same(last.value, new.value):
            self._way = self._turn = 0.0
            return False
        dt = max(new.t - last.t, 0.0)
        self._way += math.hypot(velocity[0], velocity[1]) * dt
        self._turn += abs(velocity[2]) * dt
        return self._way > self._way_m or self._turn > self._turn_rad
