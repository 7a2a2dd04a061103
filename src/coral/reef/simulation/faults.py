"""Faults of the sensors on command, to see in simulation what the vehicle does about them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, nearest
from coral.reef.vehicle.sensing import Stamped, VehicleObservation
from coral.reef.world.geometry import Frame, Label, Pose

T = TypeVar("T")

NAN = math.nan

Spoil = Callable[[VehicleObservation, VehicleObservation], VehicleObservation]
"""spoil(now, before) returns the observation of now with the fault; `before` is that of the moment it began."""


@dataclass(frozen=True)
class FaultKind:
    """One way in which sensors fail."""

    spoil: Spoil
    means: str
    """What it is, in a few words."""
    needs_sonar: bool = False
    """Whether it is one of the sonar, which not every vehicle has."""


def _pose(now: VehicleObservation, pose: Pose | None) -> VehicleObservation:
    return replace(now, pose=None if pose is None else Stamped(now.t, pose))


def _velocity(now: VehicleObservation, velocity: tuple[float, float, float] | None) -> VehicleObservation:
    return replace(now, velocity=None if velocity is None else Stamped(now.t, velocity))


def _frame(now: VehicleObservation, change: Callable[[Frame], Frame]) -> VehicleObservation:
    return replace(now, frame=None if now.frame is None else Stamped(now.frame.t, change(now.frame.value)))


def _jumped(now: VehicleObservation, before: VehicleObservation) -> VehicleObservation:
    if now.pose is None:
        return now
    x, y, theta = now.pose.value
    return _pose(now, Pose(x + 5.0, y, theta))


def _blind(frame: Frame) -> Frame:
    return Frame(
        np.full_like(frame.depth, np.inf),
        np.full_like(frame.labels, Label.WATER),
        np.full_like(frame.instances, -1),
        None if frame.rgb is None else np.zeros_like(frame.rgb),
    )


def _enlarged(frame: Frame) -> Frame:
    def larger(image: NDArray[Any]) -> NDArray[Any]:
        return np.repeat(np.repeat(image, 4, axis=0), 4, axis=1)

    rgb = None if frame.rgb is None else larger(frame.rgb)
    return Frame(larger(frame.depth), larger(frame.labels), larger(frame.instances), rgb)


def _same_again(now: VehicleObservation, before: VehicleObservation) -> VehicleObservation:
    return replace(now, frame=None if before.frame is None else Stamped(now.t, before.frame.value))


def _delayed(stamped: Stamped[T] | None, seconds: float) -> Stamped[T] | None:
    return None if stamped is None else Stamped(stamped.t + seconds, stamped.value)


def _clock_set(now: VehicleObservation, seconds: float) -> VehicleObservation:
    return replace(
        now,
        t=now.t + seconds,
        pose=_delayed(now.pose, seconds),
        velocity=_delayed(now.velocity, seconds),
        frame=_delayed(now.frame, seconds),
        attitude=_delayed(now.attitude, seconds),
        sonar=_delayed(now.sonar, seconds),
    )


def _deaf(now: VehicleObservation, _: VehicleObservation) -> VehicleObservation:
    if now.sonar is None:
        return now
    image = now.sonar.value
    return replace(now, sonar=Stamped(now.sonar.t, replace(image, ranges=np.full_like(image.ranges, np.inf))))


FAULTS: Mapping[str, FaultKind] = {
    "nan-pose": FaultKind(lambda now, _: _pose(now, Pose(NAN, NAN, NAN)), "the pose is not a number"),
    "missing-pose": FaultKind(lambda now, _: _pose(now, None), "no pose arrives"),
    "stale-pose": FaultKind(
        lambda now, before: replace(now, pose=before.pose), "the same pose with its old time stamp"
    ),
    "jumped-pose": FaultKind(_jumped, "the pose is 5 m beside the true one"),
    "nan-velocity": FaultKind(lambda now, _: _velocity(now, (NAN, NAN, NAN)), "the velocity is not a number"),
    "missing-velocity": FaultKind(lambda now, _: _velocity(now, None), "no velocity arrives"),
    "fast-velocity": FaultKind(lambda now, _: _velocity(now, (20.0, 0.0, 0.0)), "a velocity of 20 m/s"),
    "blind-camera": FaultKind(lambda now, _: _frame(now, _blind), "pictures without any return"),
    "missing-frame": FaultKind(lambda now, _: replace(now, frame=None), "no picture arrives"),
    "stale-frame": FaultKind(lambda now, _: replace(now, frame=_delayed(now.frame, -2.0)), "pictures arrive 2 s late"),
    "frozen-frame": FaultKind(_same_again, "the same picture with new time stamps"),
    "wrong-size": FaultKind(lambda now, _: _frame(now, _enlarged), "pictures of four times the width and height"),
    "unknown-label": FaultKind(
        lambda now, _: _frame(now, lambda frame: replace(frame, labels=np.full_like(frame.labels, 9))),
        "pixels of a class that there is not",
    ),
    "clock-back": FaultKind(lambda now, _: _clock_set(now, -30.0), "the computer's clock is 30 s behind"),
    "clock-ahead": FaultKind(lambda now, _: _clock_set(now, 30.0), "the computer's clock is 30 s ahead"),
    "blind-sonar": FaultKind(_deaf, "range images without any echo", needs_sonar=True),
    "missing-sonar": FaultKind(lambda now, _: replace(now, sonar=None), "no range image arrives", needs_sonar=True),
    "stale-sonar": FaultKind(
        lambda now, _: replace(now, sonar=_delayed(now.sonar, -2.0)), "range images arrive 2 s late", needs_sonar=True
    ),
}
"""All faults by name. None draws random numbers."""


@dataclass(frozen=True)
class SensorFault:
    """A fault at a time."""

    name: str
    start_s: float
    duration_s: float

    def __post_init__(self) -> None:
        if self.name not in FAULTS:
            raise InputError("--fault", "", self.name, f"one of {', '.join(FAULTS)}{nearest(self.name, FAULTS)}")

    def due(self, t: float) -> bool:
        """Check whether it is there at time `t` (s)."""
        return self.start_s - 1e-9 <= t < self.start_s + self.duration_s - 1e-9


def parse_fault(text: str) -> SensorFault:
    """Read NAME@START:DURATION, in seconds.

    Raises:
        InputError: It is something else.
    """
    name, _, times = text.partition("@")
    start, _, duration = times.partition(":")
    try:
        begin, lasts = float(start), float(duration)
    except ValueError:
        begin = lasts = NAN
    fault_name = SensorFault(name.strip(), 0.0, 0.0).name
    if not (0.0 <= begin < math.inf and 0.0 < lasts < math.inf):
        raise InputError("--fault", "", text, "NAME@START:DURATION in seconds, such as blind-camera@20:10")
    return SensorFault(fault_name, begin, lasts)


class FaultySensors:
    """Spoils what a vehicle measures while a fault is due."""

    def __init__(self, faults: Iterable[SensorFault]) -> None:
        self.faults = tuple(faults)
        self._before: dict[int, VehicleObservation] = {}

    def apply(self, seen: VehicleObservation) -> VehicleObservation:
        """Return the observation with the faults that are due at its time."""
        t = seen.t
        for k, fault in enumerate(self.faults):
            if fault.due(t):
                seen = FAULTS[fault.name].spoil(seen, self._before.setdefault(k, seen))
        return seen
