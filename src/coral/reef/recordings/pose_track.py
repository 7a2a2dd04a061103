"""Transforms with time stamps, and between them."""

from __future__ import annotations

import bisect
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.reef.recordings.transforms import interpolate_transform

NEAR_S = 0.1
"""A picture without a pose within this time of it is left out (s)."""
GAP_S = 0.5
"""Between poses farther apart than this nothing is interpolated (s)."""
ONE_CLOCK = "one clock that never goes back; cut the bag there (`mcap filter`, `ros2 bag convert`, `rosbag filter`)"
_SAME_S = 1e-6

Transform = NDArray[np.float64]


class ClockBackError(ValueError):
    """A time stamp that is older than the one before it by more than `NEAR_S`."""


@dataclass
class StampedTransforms:
    """Transforms in order of time."""

    times: list[float] = field(default_factory=list)
    transforms: list[Transform] = field(default_factory=list)
    gap_s: float = GAP_S

    @property
    def span(self) -> tuple[float, float]:
        """First and last time (s); there is one."""
        return self.times[0], self.times[-1]

    def add(self, t: float, transform: Transform) -> None:
        """Add a transform, which may be up to `NEAR_S` older than the last one.

        Raises:
            ClockBackError: It is older than that: the clock has been set back.
        """
        if self.times and t < self.times[-1] - NEAR_S:
            raise ClockBackError(f"a time stamp of {t:.3f} s after one of {self.times[-1]:.3f} s")
        at = bisect.bisect_right(self.times, t)
        self.times.insert(at, t)
        self.transforms.insert(at, transform)

    def at(self, t: float) -> Transform | None:
        """Return the transform at a time: that of this very stamp, or between two, or one near by; None without."""
        if not self.times:
            return None
        after = bisect.bisect_left(self.times, t - _SAME_S)
        if after < len(self.times) and abs(self.times[after] - t) <= _SAME_S:
            return self.transforms[after]
        if 0 < after < len(self.times):
            before = after - 1
            gap = self.times[after] - self.times[before]
            if gap <= self.gap_s:
                share = (t - self.times[before]) / gap
                return interpolate_transform(self.transforms[before], self.transforms[after], share)
        k = self.nearest(t)
        return self.transforms[k] if abs(self.times[k] - t) <= NEAR_S else None

    def nearest(self, t: float) -> int:
        """Return the index of the transform nearest in time."""
        k = bisect.bisect_left(self.times, t)
        if k == 0 or (k < len(self.times) and self.times[k] - t < t - self.times[k - 1]):
            return k
        return k - 1
