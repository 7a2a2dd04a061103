"""One tracked object: its tracker, and its filtered motion in the world or in the hand that is felt to hold it."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from coral.config import Count, Fraction, NonNegative
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseEstimate, PoseTracker
from coral.contact.scene.geometry import (
    inverse_transform,
    pose_matrix,
    rotation_angle,
    rotation_from_vector,
    rotation_vector,
)
from coral.contact.scene.observation import Array

SQUEEZE_M = 0.004
"""The commanded distance of the fingers is at least this much smaller than the measured one."""
SLACK_M = 0.008
"""Maximum gap between the object and each finger."""
KEEP = 2.0
"""Hysteresis: for a grasp already detected, the slack is multiplied by this and the squeeze divided by it."""
_PAD_X, _PAD_LOW, _PAD_HIGH = 0.01, -0.044, 0.008
"""The pads in the tool's frame (m): half their width, and their ends along the fingers."""


@dataclass(frozen=True, kw_only=True)
class MotionFilterCfg:
    """Gains and thresholds, chosen by measurement on the six tasks' episodes (docs/research/tracking.md)."""

    pictures: Count = 5
    """An object is at rest once this many successive pictures agree; its pose is then their mean."""
    still_m: NonNegative = 0.002
    still_rad: NonNegative = 0.035
    """Pictures agree within this distance of their mean: the tracker's scatter with most of the object in view."""
    position_gain: Fraction = 0.7
    """alpha of the filter."""
    velocity_gain: Fraction = 0.25
    """beta of the filter; Kalata (1984): near alpha^2 / (2 - alpha)."""
    longest_s: NonNegative = 0.12
    """Longest extrapolation beyond the last picture; contacts change faster than that."""


class MotionFilter:
    """Estimates pose x and velocity v of one rigid body from noisy poses z: an alpha-beta filter with a state of rest.

        x_pred = x + v dt,    x <- x_pred + alpha (z - x_pred),    v <- v + beta (z - x_pred) / dt

    with rotations as rotation vectors. Once the last few z agree, the body is at rest: x <- their mean, v <- 0.

    `T`, Shape=(4, 4), is the first pose, in the frame of all later ones; the body starts at rest.
    """

    def __init__(self, cfg: MotionFilterCfg, T: Array, time_s: float) -> None:
        self._cfg = cfg
        self._T, self._time_s = T, time_s
        self._recent: deque[Array] = deque([T], maxlen=cfg.pictures)
        self.velocity, self.spin = np.zeros(3), np.zeros(3)

    @property
    def resting(self) -> bool:
        """Return whether the body is estimated to be at rest."""
        return not (self.velocity.any() or self.spin.any())

    def update(self, T: Array, time_s: float) -> None:
        """Update with a measured pose, Shape=(4, 4), and the time of its picture."""
        cfg = self._cfg
        self._recent.append(T)
        mean = self._mean()
        if len(self._recent) > 1 and all(
            np.linalg.norm(each[:3, 3] - mean[:3, 3]) <= cfg.still_m
            and rotation_angle(mean[:3, :3], each[:3, :3]) <= cfg.still_rad
            for each in self._recent
        ):
            self._T, self._time_s = mean, time_s
            self.stop()
            return
        step = time_s - self._time_s
        ahead = self.predict(time_s)
        shift, turn = T[:3, 3] - ahead[:3, 3], rotation_vector(T[:3, :3] @ ahead[:3, :3].T)
        turned = rotation_from_vector(cfg.position_gain * turn) @ ahead[:3, :3]
        self._T = pose_matrix(turned, ahead[:3, 3] + cfg.position_gain * shift)
        if step > 1e-6:  # a picture from before the motion contains no speed
            self.velocity = self.velocity + cfg.velocity_gain * shift / step
            self.spin = self.spin + cfg.velocity_gain * turn / step
            self._time_s = time_s

    def predict(self, time_s: float) -> Array:
        """Predict the pose at a time, at the present velocity. Shape=(4, 4)."""
        since = min(max(time_s - self._time_s, 0.0), self._cfg.longest_s)
        turned = rotation_from_vector(since * self.spin) @ self._T[:3, :3]
        return pose_matrix(turned, self._T[:3, 3] + since * self.velocity)

    def stop(self) -> None:
        """Set the velocity to zero."""
        self.velocity, self.spin = np.zeros(3), np.zeros(3)

    def _mean(self) -> Array:
        last = self._recent[-1]
        turn = np.mean([rotation_vector(each[:3, :3] @ last[:3, :3].T) for each in self._recent], axis=0)
        place = np.mean([each[:3, 3] for each in self._recent], axis=0)
        return pose_matrix(rotation_from_vector(turn) @ last[:3, :3], place)


_IN_HAND = MotionFilterCfg(position_gain=0.3, velocity_gain=0.0)
"""Squeezed between rubber pads an object moves with them; any other motion in the pictures is mostly noise."""


def is_grasped(shape: ObjectModel, T_tool_object: Array, opening_m: float, wanted_m: float, before: bool) -> bool:
    """Decide whether the fingers, commanded to close further than they can, hold the object, as they may have `before`.

    T_tool_object, Shape=(4, 4), is estimated; the openings are the measured and the commanded distance of the pads.
    """
    ease = KEEP if before else 1.0
    if opening_m - wanted_m < SQUEEZE_M / ease:
        return False
    points = shape.points @ T_tool_object[:3, :3].T + T_tool_object[:3, 3]
    reach = 0.005 * (ease - 1.0)
    x, z = np.abs(points[:, 0]), points[:, 2]
    near = points[(x < _PAD_X + reach) & (z > _PAD_LOW) & (z < _PAD_HIGH + reach)]
    if len(near) < 4:
        return False
    low, high = float(near[:, 1].min()), float(near[:, 1].max())
    slack = SLACK_M * ease
    return abs(high - opening_m / 2) < slack and abs(low + opening_m / 2) < slack


class TrackedObject:
    """Tracks one object in the frame in which it rests: the world's, or the hand's while the fingers hold it."""

    def __init__(self, tracker: PoseTracker) -> None:
        self.tracker = tracker
        self.held = False
        self.lost_since: float | None = None
        self.motion: MotionFilter | None = None

    def measure(self, estimate: PoseEstimate, tool: Array, time_s: float) -> None:
        """Update its motion by a pose that is not lost, with the hand at T_world_tool; a registered one begins anew."""
        T = inverse_transform(tool) @ estimate.T_world_object if self.held else estimate.T_world_object
        if self.motion is None or estimate.registered:
            self.begin(T, time_s)
        else:
            self.motion.update(T, time_s)

    def feel(self, shape: ObjectModel, tool: Array, opening_m: float, wanted_m: float, time_s: float) -> None:
        """Decide by `is_grasped` whether the fingers hold it, with the hand at T_world_tool."""
        inside = inverse_transform(tool) @ self.at(tool, time_s)
        self.hold(is_grasped(shape, inside, opening_m, wanted_m, self.held), tool, time_s)

    def hold(self, held: bool, tool: Array, time_s: float) -> None:
        """Change to the hand's frame, T_world_tool, Shape=(4, 4), if it is now `held`, or back to the world's."""
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
