"""The guard of the sensors: nothing reaches the map or the controller that it has not checked."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction, NonNegative, Positive
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.pilot import checks
from coral.reef.pilot.checks import FrozenSensor, UnfitMeasurement, finite_numbers
from coral.reef.pilot.dead_reckoning import REMEMBERED, PoseHistory
from coral.reef.pilot.loop_time import LoopTime
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Attitude, Stamped, VehicleObservation, Velocity
from coral.reef.world.geometry import Frame, Pose

T = TypeVar("T")

Input = Literal["clock", "pose", "velocity", "camera", "attitude", "sonar"]
NEEDED: tuple[Input, ...] = ("pose", "velocity", "camera")
"""Without one of these nothing moves. A sonar that works stands in for the camera once there have been pictures."""

TINY_S = 1e-9
"""Ticks are multiples of 0.1 s in floating point."""
AFTER_JUMP_S = 1.0
"""The vehicle may have driven on this long since a pose jumped: then it stands, and no jump is believed for its age."""


@dataclass(frozen=True, kw_only=True)
class GuardCfg:
    """Limits within which measurements are believed, and what follows when they are not. None is from the paper."""

    pose_timeout_s: Positive = 0.45
    """Age at which a pose is lost. Until then it is moved on with the velocity: at cruise speed by 0.3 m. A vehicle at
    cruise speed then stands within 1 s of its last pose."""
    velocity_timeout_s: Positive = 0.45
    frame_timeout_s: Positive = 0.35
    """Age at which the camera is lost, beyond the time that its pictures take to arrive (`coral reef sail
    --camera-latency`): three pictures at 10 Hz."""
    sonar_timeout_s: Positive = 0.35
    """Age at which the sonar is lost: at 5 Hz, one image may be missing. A vehicle without a camera, which drives at
    half speed, then stands within 1 s of the loss."""
    hesitate_s: NonNegative = 0.1
    """This long before camera and sonar are both lost the vehicle already brakes, since it sees no obstacles: at
    cruise speed it then stands within 1 s of the loss. Two pictures at 10 Hz may be missing before it does."""
    future_s: NonNegative = 0.05
    """A stamp may be this far ahead of the control loop's clock: half a period."""
    gap_s: Positive = 1.0
    """The clock may advance by this much from tick to tick; with more, or backwards, it has jumped."""
    max_speed_m_s: Positive = 1.5
    """Fastest vehicle that is believed: 2.5 times the cruise speed, more than a BlueROV2 can do."""
    max_yaw_rate_rad_s: Positive = 2.0
    jump_m: Positive = 0.5
    """A pose may differ by this much, beyond what the fastest vehicle can drive: fixes of a position are rough."""
    jump_rad: Positive = 0.4
    outside_m: NonNegative = 20.0
    """A pose may lie this far outside the survey area."""
    max_sigma_m: Positive = 2.0
    """Largest standard deviation of a position, where it is known: the size of a cluster."""
    max_tilt_rad: Positive = 0.8
    """Largest roll and pitch of a vehicle that holds itself level."""
    min_seen: Fraction = 0.01
    """Share of the pixels that must have a return. The camera looks down and always sees the seabed before it."""
    frozen_m: Positive = 0.05
    """Equal pictures over this distance mean that the camera hangs. Where only classes and depth are known, they must
    show an oyster or an obstacle: bare seabed may look the same everywhere."""
    frozen_rad: Positive = 0.05
    """The same for a turn."""
    min_heard: Fraction = 0.01
    """Share of the sonar's beams that must have an echo. It is mounted so that it always hears the sea floor."""
    recover_s: NonNegative = 1.0
    """Inputs must have passed for this long before a held vehicle continues."""
    surface_after_s: Positive | None = 60.0
    """A vehicle that has been held for this long surfaces. None: it holds until someone comes."""


@dataclass(frozen=True, kw_only=True)
class Refusal:
    """A measurement that was not used."""

    input: Input
    reason: str
    """Its name: stale, jumped, blind, wrong size, ..."""
    detail: str = ""

    def __str__(self) -> str:
        return f"{self.input} {self.reason}" + (f" ({self.detail})" if self.detail else "")


@dataclass(frozen=True, kw_only=True)
class Reading:
    """What of an observation can be used."""

    t: float
    """Time for the pilot (s): that of the control loop, without its jumps."""
    pose: Pose | None
    """The last pose, moved on to now with the velocity; None before the first."""
    velocity: Velocity
    """The last velocity; 0 before the first."""
    frame: Frame | None
    """A new picture; None if there is none, or nobody knows where it was taken."""
    frame_pose: Pose | None
    """The pose at which it was taken."""
    attitude: Attitude | None
    """The attitude in which it was taken: the last one not later than the picture; None: unknown."""
    refusals: tuple[Refusal, ...]
    """What was refused in this tick."""
    lost: str
    """What has been missing or wrong for too long, in words; "" while everything needed is there."""
    sonar: RangeImage | None = None
    """A new range image; None if there is none, or nobody knows where it was taken."""
    sonar_pose: Pose | None = None
    """The pose at which it was taken."""
    sonar_attitude: Attitude | None = None
    """The attitude in which it was taken, as that of the picture."""
    deaf: str = ""
    """Why there are no range images, in words, although the vehicle has a sonar; "" while it works."""
    blind: str = ""
    """Why there are no pictures, in words, while the sonar alone shows the way; "" while the camera works."""
    covariance: NDArray[np.float64] | None = None
    """Of the last pose (x, y, theta), in m and rad; None: unknown. Shape=(3, 3)."""
    overdue: bool = False
    """Whether all that shows obstacles is late: it is about to be lost."""


class SensorGuard:
    """Checks every observation: finite, of the right shape and type, new, not too old, within the limits of a vehicle.

    What is wrong is refused with a name. A single wrong measurement changes nothing: the one before is used until it
    is too old. A lasting jump of the position is refused for good, since the map would no longer fit; `relocate`
    accepts it on a person's word.
    """

    def __init__(
        self,
        camera: CameraCfg,
        size_m: tuple[float, float],
        cfg: GuardCfg | None = None,
        sonar: SonarCfg | None = None,
        *,
        sonar_alone: Callable[[], bool] = lambda: False,
    ) -> None:
        """Set up for a survey area (m) whose corner is the origin; without a sonar its images are not looked at.

        `sonar_alone` tells whether only the sonar finds obstacles: then nothing moves without it.
        """
        self.cfg, self._camera, self._size_m = cfg or GuardCfg(), camera, size_m
        self._sonar, self._sonar_alone = sonar, sonar_alone
        self._timeouts: dict[Input, float] = {
            "pose": self.cfg.pose_timeout_s,
            "velocity": self.cfg.velocity_timeout_s,
            "camera": self.cfg.frame_timeout_s,
            "attitude": self.cfg.pose_timeout_s,
            "sonar": self.cfg.sonar_timeout_s,
        }
        self._time = LoopTime(self.cfg.gap_s)
        self._stamps: dict[Input, float] = {}
        """Stamp of the last measurement of each input, used or refused."""
        self._good: dict[Input, float] = {}
        """Time of the last good measurement of each input, on the pilot's clock (s)."""
        self._why: dict[Input, Refusal] = {}
        """Last refusal of each input since its last good measurement."""
        self._poses = PoseHistory(self.cfg.pose_timeout_s)
        self._reference: Stamped[Pose] | None = None
        """Pose from which the next one may not have jumped, and since when it may have moved."""
        self._covariance: NDArray[np.float64] | None = None
        self._jumped = False
        self._seen = FrozenSensor[Frame](checks.picture_key, self.cfg.frozen_m, self.cfg.frozen_rad)
        self._heard = FrozenSensor[RangeImage](checks.echo_key, self.cfg.frozen_m)
        self.attitude: Attitude | None = None
        """The last attitude that passed."""
        self._attitudes: deque[Stamped[Attitude]] = deque(maxlen=REMEMBERED)

    def check(self, seen: VehicleObservation) -> Reading:
        """Check an observation. Never raises, whatever is in it."""
        refused: list[Refusal] = []
        self._advance(seen.t, refused)
        pose = self._take("pose", seen.pose, lambda new: self._check_pose(new, seen.covariance), refused)
        if pose is not None:
            self._reference = pose
            self._poses.add(pose)
            self._covariance = None if seen.covariance is None else np.array(seen.covariance, np.float64)
        velocity = self._take("velocity", seen.velocity, self._check_velocity, refused)
        if velocity is not None:
            self._poses.velocity = velocity.value
        attitude = self._take("attitude", seen.attitude, self._check_attitude, refused)
        if attitude is not None:
            self.attitude = attitude.value
            self._attitudes.append(attitude)
        frame = self._take("camera", seen.frame, self._check_frame, refused)
        heard = None if self._sonar is None else self._take("sonar", seen.sonar, self._check_sonar, refused)
        self._why |= {refusal.input: refusal for refusal in refused}
        located = self._age("pose") <= self.cfg.pose_timeout_s + TINY_S
        there = self._poses.at(frame.t) if frame is not None and located else None
        heard_from = self._poses.at(heard.t) if heard is not None and located else None
        return Reading(
            t=self._time.t,
            pose=self._poses.at(self._time.t - self._time.offset if self._time.clock is None else self._time.clock),
            velocity=self._poses.velocity,
            frame=frame.value if frame is not None and there is not None else None,
            frame_pose=there,
            attitude=None if frame is None else self._attitude_at(frame.t),
            refusals=tuple(refused),
            lost=self._lost(),
            sonar=heard.value if heard is not None and heard_from is not None else None,
            sonar_pose=heard_from,
            sonar_attitude=None if heard is None else self._attitude_at(heard.t),
            deaf=self._missing(("sonar",)) if self._sonar is not None else "",
            blind=self._missing(("camera",)) if self._sonar_stands_in else "",
            covariance=self._covariance,
            overdue=self._overdue(),
        )

    def is_refused(self, name: Input) -> bool:
        """Check whether an input has been refused since its last good measurement."""
        return name in self._why

    def relocate(self) -> None:
        """Accept the next pose wherever it is, on a person's word."""
        self._reference, self._jumped = None, False

    def _advance(self, clock: object, refused: list[Refusal]) -> None:
        """Go to the next tick; after a jump of the clock, stamps from before it count for nothing."""
        offset = self._time.offset
        try:
            self._time.advance(clock)
            self._why.pop("clock", None)
        except UnfitMeasurement as fault:
            refused.append(Refusal(input="clock", reason=fault.reason, detail=fault.detail))
        if self._time.offset != offset:
            self._stamps.clear()
            self._poses.shift(offset - self._time.offset)
            moved = [replace(each, t=each.t + offset - self._time.offset) for each in self._attitudes]
            self._attitudes = deque(moved, maxlen=REMEMBERED)
            if self._reference is not None:
                self._reference = replace(self._reference, t=self._reference.t + offset - self._time.offset)

    def _take(
        self, name: Input, stamped: Stamped[Any] | None, check: Callable[[Stamped[Any]], T], refused: list[Refusal]
    ) -> Stamped[T] | None:
        """Return a measurement that is new and passes; None otherwise."""
        if stamped is None or self._time.clock is None:
            return None
        try:
            if not self._is_new(name, stamped, self._time.clock):
                return None
            self._stamps[name] = stamped.t
            value = check(stamped)
        except UnfitMeasurement as fault:
            refused.append(Refusal(input=name, reason=fault.reason, detail=fault.detail))
            return None
        self._good[name] = stamped.t + self._time.offset
        self._why.pop(name, None)
        return Stamped(stamped.t, value)

    def _is_new(self, name: Input, stamped: Stamped[Any], now: float) -> bool:
        """Check when a measurement was made; False if it is the last one again."""
        if not isinstance(stamped, Stamped):
            raise UnfitMeasurement("wrong type", f"{type(stamped).__name__}, without a time stamp")
        age, last = now - finite_numbers((stamped.t,), 1)[0], self._stamps.get(name)
        if age < -self.cfg.future_s:
            raise UnfitMeasurement("from the future", f"by {-age:.2f} s")
        if age > self._timeouts[name] + TINY_S:
            raise UnfitMeasurement("stale", f"{age:.1f} s old")
        if last is not None and stamped.t < last:
            raise UnfitMeasurement("out of order", f"{last - stamped.t:.2f} s before the last one")
        return stamped.t != last

    def _check_pose(self, stamped: Stamped[Any], covariance: object) -> Pose:
        x, y, theta = finite_numbers(stamped.value, 3)
        cfg, before, pose = self.cfg, self._reference, Pose(x, y, theta)
        checks.check_area(pose, self._size_m, cfg.outside_m)
        if covariance is not None:
            checks.check_covariance(covariance, cfg.max_sigma_m)
        if before is None:
            return pose
        dt = min(max(stamped.t - before.t, 0.0), AFTER_JUMP_S if self._jumped else math.inf)
        most = cfg.jump_m + cfg.max_speed_m_s * dt, cfg.jump_rad + cfg.max_yaw_rate_rad_s * dt
        try:
            checks.check_jump(before.value, pose, *most)
        except UnfitMeasurement:
            self._jumped = True
            raise
        self._jumped = False
        return pose

    def _check_velocity(self, stamped: Stamped[Any]) -> Velocity:
        u, v, r = finite_numbers(stamped.value, 3)
        checks.check_velocity((u, v, r), self.cfg.max_speed_m_s, self.cfg.max_yaw_rate_rad_s)
        return u, v, r

    def _check_attitude(self, stamped: Stamped[Any]) -> Attitude:
        found = stamped.value
        if not isinstance(found, Attitude):
            raise UnfitMeasurement("wrong type", f"{type(found).__name__}, not an Attitude")
        roll, pitch, depth_m = finite_numbers((found.roll, found.pitch, found.depth_m), 3)
        checks.check_attitude(roll, pitch, depth_m, self.cfg.max_tilt_rad)
        return found

    def _attitude_at(self, t: float) -> Attitude | None:
        """Return the last attitude not later than `t` (s), if it is not too old."""
        for each in reversed(self._attitudes):
            if each.t <= t + TINY_S:
                return each.value if t - each.t <= self._timeouts["attitude"] + TINY_S else None
        return None

    def _check_frame(self, stamped: Stamped[Any]) -> Frame:
        frame = checks.check_frame(stamped.value, self._camera, self.cfg.min_seen)
        hangs = self._seen.update(Stamped(stamped.t, frame), self._poses.velocity)
        if hangs and checks.has_landmarks(frame):
            raise UnfitMeasurement(hangs, "the same picture while the vehicle moves")
        if frame.depth.flags.c_contiguous and frame.labels.flags.c_contiguous:
            return frame
        # Kernels are compiled for contiguous arrays: another layout would compile them again, for seconds.
        return replace(frame, depth=np.ascontiguousarray(frame.depth), labels=np.ascontiguousarray(frame.labels))

    def _check_sonar(self, stamped: Stamped[Any]) -> RangeImage:
        assert self._sonar is not None
        image = checks.check_range_image(stamped.value, self._sonar, self.cfg.min_heard)
        if hangs := self._heard.update(Stamped(stamped.t, image), self._poses.velocity):
            raise UnfitMeasurement(hangs, "the same image while the vehicle moves")
        return image

    @property
    def _sonar_stands_in(self) -> bool:
        """Whether the sonar works, and may stand in for a camera that has worked before."""
        heard = self._age("sonar") <= self._timeouts["sonar"] + TINY_S
        return self._sonar is not None and heard and math.isfinite(self._age("camera"))

    def _age(self, name: Input) -> float:
        """Return the age of the last good measurement of an input (s); inf before the first."""
        return self._time.t - self._good.get(name, -math.inf)

    def _overdue(self) -> bool:
        """Check whether all that shows obstacles is nearly as old as it may be."""
        eyes: tuple[Input, ...] = ("camera",) if self._sonar is None else ("camera", "sonar")
        eyes = ("sonar",) if self._sonar is not None and self._sonar_alone() else eyes
        return all(self._age(name) > self._timeouts[name] - self.cfg.hesitate_s + TINY_S for name in eyes)

    def _lost(self) -> str:
        """Name the needed inputs without a good measurement within their time."""
        needed = [name for name in NEEDED if name != "camera" or not self._sonar_stands_in]
        if self._sonar is not None and (self._sonar_alone() or self._missing(("camera",))) and "sonar" not in needed:
            needed.append("sonar")
        return self._missing(needed)

    def _missing(self, names: Iterable[Input]) -> str:
        """Name those of some inputs that have no good measurement within their time, and why."""
        found = []
        for name in names:
            age = self._age(name)
            if age > self._timeouts[name] + TINY_S:
                why = self._why.get(name) or self._why.get("clock")
                what = str(why) if why is not None else f"{name} missing"
                found.append(what + (f", for {age:.1f} s" if math.isfinite(age) else ""))
        return "; ".join(dict.fromkeys(found))
