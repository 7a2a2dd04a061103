"""What a measurement must satisfy: one check for each input, which raises the name of what is wrong; hung sensors."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Stamped, Velocity
from coral.reef.world.geometry import Frame, Label, Pose, wrap

T = TypeVar("T")

BLACK, PLAIN = 12, 3
"""Of 255 levels. A picture is black if 98 % of its pixels are darker than the first, and plain if they differ by no
more than the second: compressed pictures of open water differ by more."""
REMEMBERED = 3000
"""Measurements against which a new one is compared: five minutes at 10 Hz."""

SURFACE_M = 0.5
"""A depth sensor may put a vehicle at the surface so far above it: waves, and its own offset."""


class UnfitMeasurement(ValueError):
    """A measurement that must not be used."""

    def __init__(self, reason: str, detail: str = "") -> None:
        super().__init__(reason, detail)
        self.reason, self.detail = reason, detail


def finite_numbers(value: object, count: int) -> tuple[float, ...]:
    """Return `count` finite numbers.

    Raises:
        UnfitMeasurement: It is something else.
    """
    try:
        found = tuple(float(v) for v in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError, OverflowError):
        raise UnfitMeasurement("wrong type", f"{type(value).__name__}, not {count} numbers") from None
    if len(found) != count:
        raise UnfitMeasurement("wrong size", f"{len(found)} numbers, not {count}")
    if not all(map(math.isfinite, found)):
        raise UnfitMeasurement("not finite", ", ".join(f"{v:g}" for v in found))
    return found


def check_velocity(velocity: Sequence[float], speed_m_s: float, yaw_rate_rad_s: float) -> None:
    """Check a velocity (m/s, m/s, rad/s) against the fastest that is believed."""
    speed = math.hypot(velocity[0], velocity[1])
    if speed > speed_m_s:
        raise UnfitMeasurement("too fast", f"{speed:.1f} m/s, more than {speed_m_s:g} m/s")
    if abs(velocity[2]) > yaw_rate_rad_s:
        raise UnfitMeasurement("too fast", f"{velocity[2]:.1f} rad/s, more than {yaw_rate_rad_s:g} rad/s")


def check_area(pose: Pose, size_m: tuple[float, float], margin_m: float) -> None:
    """Check that a pose is within `margin_m` of the survey area, which begins at the origin."""
    if not (-margin_m <= pose.x <= size_m[0] + margin_m and -margin_m <= pose.y <= size_m[1] + margin_m):
        raise UnfitMeasurement(
            "outside", f"({pose.x:.1f}, {pose.y:.1f}) m, more than {margin_m:g} m outside of the survey area"
        )


def check_jump(before: Pose, pose: Pose, way_m: float, turn_rad: float) -> None:
    """Check that a pose is within `way_m` (m) and `turn_rad` (rad) of the one before."""
    moved, turned = math.dist(before[:2], pose[:2]), abs(wrap(pose.theta - before.theta))
    if moved > way_m:
        raise UnfitMeasurement("jumped", f"by {moved:.1f} m, where {way_m:.1f} m is the most")
    if turned > turn_rad:
        raise UnfitMeasurement("jumped", f"by {turned:.1f} rad, where {turn_rad:.1f} rad is the most")


def check_covariance(covariance: object, sigma_m: float) -> None:
    """Check a pose's covariance (m, m, rad), Shape=(3, 3), against the largest standard deviation of a position."""
    try:
        found = np.asarray(covariance, np.float64)
    except (TypeError, ValueError):
        raise UnfitMeasurement("wrong type", "a covariance that is no matrix of numbers") from None
    if found.shape != (3, 3):
        raise UnfitMeasurement("wrong size", f"a covariance of shape {found.shape}, not (3, 3)")
    spread = np.diag(found)
    if not (np.isfinite(found).all() and (spread >= 0.0).all()):
        raise UnfitMeasurement("not finite", "a covariance that is not finite, or negative on its diagonal")
    sigma = math.sqrt(float(spread[:2].max()))
    if sigma > sigma_m:
        raise UnfitMeasurement("uncertain", f"by {sigma:.1f} m, where {sigma_m:g} m is the most")


def check_attitude(roll: float, pitch: float, depth_m: float, tilt_rad: float) -> None:
    """Check roll and pitch (rad) against the most that is believed, and that the depth (m) is below the surface."""
    if max(abs(roll), abs(pitch)) > tilt_rad:
        raise UnfitMeasurement(
            "too far tilted", f"roll {roll:.1f}, pitch {pitch:.1f} rad, where {tilt_rad:g} rad is the most"
        )
    if depth_m < -SURFACE_M:
        raise UnfitMeasurement("negative depth", f"{depth_m:.1f} m below the surface")


def check_frame(frame: object, camera: CameraCfg, least_seen: float) -> Frame:
    """Return a picture after checking shape, type, values and colours, and that a share of its pixels has a return."""
    if not isinstance(frame, Frame):
        raise UnfitMeasurement("wrong type", f"{type(frame).__name__}, not a Frame")
    shape = (camera.height, camera.width)
    for name, image, dtype in (("depth", frame.depth, np.float32), ("labels", frame.labels, np.uint8)):
        if not isinstance(image, np.ndarray) or image.dtype != dtype:
            kind = image.dtype if isinstance(image, np.ndarray) else type(image).__name__
            raise UnfitMeasurement("wrong type", f"{name} is {kind}, not {np.dtype(dtype)}")
        if image.shape != shape:
            found, wanted = "x".join(map(str, image.shape[::-1])), f"{camera.width}x{camera.height}"
            raise UnfitMeasurement("wrong size", f"{name} is {found}, the configured camera {wanted}")
    highest = int(frame.labels.max())
    if highest > max(Label):
        raise UnfitMeasurement("unknown label", f"{highest}, where {int(max(Label))} is the last")
    if (frame.depth <= 0.0).any():
        raise UnfitMeasurement("not positive", "a depth of 0 m or less; what has no return is inf")
    if frame.rgb is not None:
        check_colours(frame.rgb)
    seen = np.count_nonzero(np.isfinite(frame.depth)) / frame.depth.size
    if seen < least_seen:
        raise UnfitMeasurement("blind", f"{seen:.1%} of the pixels have a return")
    return frame


def check_range_image(image: object, sonar: SonarCfg, least_heard: float) -> RangeImage:
    """Return a range image after checking type, shape, view and values, and that a share of its beams has an echo."""
    if not isinstance(image, RangeImage):
        raise UnfitMeasurement("wrong type", f"{type(image).__name__}, not a RangeImage")
    ranges = image.ranges
    if not isinstance(ranges, np.ndarray) or ranges.dtype != np.float32:
        kind = ranges.dtype if isinstance(ranges, np.ndarray) else type(ranges).__name__
        raise UnfitMeasurement("wrong type", f"ranges are {kind}, not float32")
    if ranges.shape != (sonar.height, sonar.width):
        found = "x".join(map(str, ranges.shape[::-1]))
        raise UnfitMeasurement("wrong size", f"ranges are {found}, the configured sonar {sonar.width}x{sonar.height}")
    view, wanted = finite_numbers((image.hfov_deg, image.vfov_deg), 2), (sonar.hfov_deg, sonar.vfov_deg)
    if max(abs(a - b) for a, b in zip(view, wanted, strict=True)) > 0.5:
        raise UnfitMeasurement(
            "wrong field of view", f"{view[0]:g} by {view[1]:g} degrees, not {wanted[0]:g} by {wanted[1]:g}"
        )
    if not (ranges > 0.0).all():
        raise UnfitMeasurement("not positive", "a range that is no number above 0 m; what has no echo is inf")
    heard = np.count_nonzero(np.isfinite(ranges)) / ranges.size
    if heard < least_heard:
        raise UnfitMeasurement("blind", f"{heard:.1%} of the beams have an echo")
    return image


def check_colours(rgb: NDArray[np.uint8]) -> None:
    """Check that a picture, Shape=(H, W, 3), shows something; a text in it does not count, nor do a few bright dots."""
    low, high = np.percentile(rgb[::4, ::4].reshape(-1, 3), (2.0, 98.0), axis=0)
    if high.max() < BLACK:
        raise UnfitMeasurement("black", f"hardly a pixel is brighter than {high.max():.0f} of 255")
    if (high - low).max() <= PLAIN:
        raise UnfitMeasurement("plain", "one colour all over")


def has_landmarks(frame: Frame) -> bool:
    """Check whether a picture must look different after a move: classes and depth of bare seabed need not."""
    return frame.rgb is not None or bool(((frame.labels == Label.OYSTER) | (frame.labels == Label.OBSTACLE)).any())


def picture_key(frame: Frame) -> int:
    """Return a number that is equal for equal pictures: of the colours, since eyes add what else they know."""
    seen = frame.labels.tobytes() + frame.depth.tobytes() if frame.rgb is None else frame.rgb.tobytes()
    return hash(seen)


def echo_key(image: RangeImage) -> int:
    """Return a number that is equal for equal range images."""
    return hash(image.ranges.tobytes())


class FrozenSensor(Generic[T]):
    """Finds a sensor that hangs: it delivers the same again with new time stamps, while the vehicle moves.

    Motion is that of the measured velocity: a drifting position moves without any motion.
    """

    def __init__(self, key: Callable[[T], int], way_m: float, turn_rad: float = math.inf) -> None:
        """Set up; what has the same key again after more than `way_m` (m) or `turn_rad` (rad) cannot be new."""
        self._key, self._way_m, self._turn_rad = key, way_m, turn_rad
        self._known: dict[int, tuple[float, float]] = {}
        """How far the vehicle had moved and turned when each of the last measurements came first."""
        self._last = 0
        self._t = math.inf
        self._way = self._turn = 0.0

    def update(self, new: Stamped[T], velocity: Velocity) -> str:
        """Take in the next measurement and the present velocity (m/s, m/s, rad/s).

        Return "frozen" if it is the last one again, "repeated" if it is one from before, as of a stream that plays a
        piece again and again, and "" if it is new.
        """
        dt, self._t = max(new.t - self._t, 0.0), new.t
        self._way += math.hypot(velocity[0], velocity[1]) * dt
        self._turn += abs(velocity[2]) * dt
        key = self._key(new.value)
        state, self._last = "frozen" if key == self._last else "repeated", key
        way, turn = self._known.setdefault(key, (self._way, self._turn))
        if len(self._known) > REMEMBERED:
            del self._known[next(iter(self._known))]
        return state if self._way - way > self._way_m or self._turn - turn > self._turn_rad else ""
