"""What is known of an object's motion between pictures and ahead of them: at rest, or at an even velocity."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Fraction, NonNegative
from coral.contact.scene.geometry import rotation_angle, rotation_from_vector, rotation_vector
from coral.contact.scene.rigid_transform import pose_matrix

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class MotionFilterCfg:
    """Chosen by measurement on the six tasks' episodes (docs/contact-perception.md)."""

    pictures: Count = 5
    """So many pictures in a row that agree show an object at rest; their mean is where it is."""
    still_m: NonNegative = 0.002
    still_rad: NonNegative = 0.035
    """How far from their mean they may lie for that: what the tracker scatters with most of the object in view."""
    position_gain: Fraction = 0.7
    velocity_gain: Fraction = 0.25
    """Shares of a picture's surprise that go into the pose and the velocity of something that moves (an alpha-beta
    filter; Kalata 1984: the second is near the square of the first over 2 - first)."""
    longest_s: NonNegative = 0.12
    """A motion is carried on for so long without a picture: contacts change faster than that."""


class MotionFilter:
    """Follows one rigid body in one frame, whichever that is.

    Args:
        cfg: How.
        T: Shape=(4, 4), where it is at first; it is held to be at rest.
        time_s: When.
    """

    def __init__(self, cfg: MotionFilterCfg, T: Array, time_s: float) -> None:
        self._cfg = cfg
        self._T, self._time_s = T, time_s
        self._recent: deque[Array] = deque([T], maxlen=cfg.pictures)
        self.velocity, self.spin = np.zeros(3), np.zeros(3)

    @property
    def resting(self) -> bool:
        """Whether it is held to be at rest."""
        return not (self.velocity.any() or self.spin.any())

    def measure(self, T: Array, time_s: float) -> None:
        """Take in where a picture shows it, Shape=(4, 4), and when that was taken."""
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
        ahead = self.at(time_s)
        shift, turn = T[:3, 3] - ahead[:3, 3], rotation_vector(T[:3, :3] @ ahead[:3, :3].T)
        self._T = pose_matrix(
            rotation_from_vector(cfg.position_gain * turn) @ ahead[:3, :3], ahead[:3, 3] + cfg.position_gain * shift
        )
        if step > 1e-6:  # a picture from before this motion began says nothing of its speed
            self.velocity = self.velocity + cfg.velocity_gain * shift / step
            self.spin = self.spin + cfg.velocity_gain * turn / step
            self._time_s = time_s

    def at(self, time_s: float) -> Array:
        """Where it is at a time, Shape=(4, 4), if it goes on as it does."""
        since = min(max(time_s - self._time_s, 0.0), self._cfg.longest_s)
        return pose_matrix(
            rotation_from_vector(since * self.spin) @ self._T[:3, :3], self._T[:3, 3] + since * self.velocity
        )

    def stop(self) -> None:
        """Hold it to be at rest where it is."""
        self.velocity, self.spin = np.zeros(3), np.zeros(3)

    def _mean(self) -> Array:
        last = self._recent[-1]
        turn = np.mean([rotation_vector(each[:3, :3] @ last[:3, :3].T) for each in self._recent], axis=0)
        return pose_matrix(
            rotation_from_vector(turn) @ last[:3, :3], np.mean([each[:3, 3] for each in self._recent], axis=0)
        )
