"""Poses between and after measurements: interpolated, or moved on with the last velocity."""

from __future__ import annotations

import math
from collections import deque

from coral.reef.vehicle.sensing import Stamped, Velocity
from coral.reef.world.geometry import Pose, wrap

REMEMBERED = 32
"""Number of poses that are kept: three seconds at 10 Hz, longer than a picture takes to arrive."""


class PoseHistory:
    """Remembers the last poses, for pictures that were taken between two of them and arrive late."""

    def __init__(self, longest_s: float) -> None:
        """Set up; no pose is moved on for more than `longest_s` (s)."""
        self.velocity: Velocity = (0.0, 0.0, 0.0)
        """The last velocity, with which the last pose is moved on."""
        self._longest_s = longest_s
        self._poses: deque[Stamped[Pose]] = deque(maxlen=REMEMBERED)

    def add(self, pose: Stamped[Pose]) -> None:
        """Append a pose that is newer than the others."""
        self._poses.append(pose)

    def shift(self, seconds: float) -> None:
        """Add `seconds` to all stamps: the clock that they are on has been set."""
        moved = [Stamped(pose.t + seconds, pose.value) for pose in self._poses]
        self._poses.clear()
        self._poses.extend(moved)

    def at(self, t: float) -> Pose | None:
        """Return the pose at time `t` (s) on the clock of the stamps; None before the first pose."""
        if not self._poses:
            return None
        after = self._poses[-1]
        if t >= after.t:
            return moved_on(after.value, self.velocity, min(t - after.t, self._longest_s))
        for before in reversed(self._poses):
            if before.t <= t:
                return between(before.value, after.value, (t - before.t) / (after.t - before.t))
            after = before
        return after.value


def moved_on(pose: Pose, velocity: Velocity, dt: float) -> Pose:
    """Move a pose on with a constant velocity for `dt` seconds (midpoint rule); with 0 it is the same."""
    if dt == 0.0:
        return pose
    u, v, r = velocity
    middle = pose.theta + 0.5 * r * dt
    c, s = math.cos(middle), math.sin(middle)
    return Pose(pose.x + (c * u - s * v) * dt, pose.y + (s * u + c * v) * dt, wrap(pose.theta + r * dt))


def between(before: Pose, after: Pose, share: float) -> Pose:
    """Interpolate two poses; `share` is 0 at the first and 1 at the second."""
    return Pose(
        before.x + share * (after.x - before.x),
        before.y + share * (after.y - before.y),
        wrap(before.theta + share * wrap(after.theta - before.theta)),
    )
