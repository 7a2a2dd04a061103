"""Sensors that fail for a time, between a robot's vehicle and its pilot."""

from dataclasses import replace

import numpy as np

from coral.reef.vehicle.sensing import Stamped
from coral.reef.world.geometry import Frame, Label, Pose

NAN = np.nan


def _frame(now, change):
    return replace(now, frame=Stamped(now.frame.t, change(now.frame.value)))


def _blind(frame):
    return replace(frame, depth=np.full_like(frame.depth, np.inf), labels=np.full_like(frame.labels, Label.WATER))


def _enlarged(frame):
    return Frame(
        *(np.kron(image, np.ones((4, 4), image.dtype)) for image in (frame.depth, frame.labels, frame.instances))
    )


FAILURES = {
    "nan-pose": lambda now, _: replace(now, pose=Stamped(now.t, Pose(NAN, NAN, NAN))),
    "stale-pose": lambda now, before: replace(now, pose=before.pose),
    "nan-velocity": lambda now, _: replace(now, velocity=Stamped(now.t, (NAN, NAN, NAN))),
    "blind-camera": lambda now, _: _frame(now, _blind),
    "missing-frame": lambda now, _: replace(now, frame=None),
    "stale-frame": lambda now, _: replace(now, frame=Stamped(now.frame.t - 2.0, now.frame.value)),
    "wrong-size": lambda now, _: _frame(now, _enlarged),
    "missing-sonar": lambda now, _: replace(now, sonar=None),
}
"""failure(now, before) returns what is measured now; `before` is what was measured when it began."""


def fail(vehicle, name, begin_s, end_s):
    """Let sensors of a vehicle fail from one time to another (s)."""
    observe, before = vehicle.observe, []

    def failing(t):
        now = observe(t)
        if not begin_s - 1e-9 <= now.t < end_s - 1e-9:
            return now
        before.append(now)
        return FAILURES[name](now, before[0])

    vehicle.observe = failing
