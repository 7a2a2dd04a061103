"""All objects of a scene followed at once: pictures in, poses and velocities out, as an `Observation` wants them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.rotation import vector
from coral.contact.perception.tracker import PoseEstimate, PoseTracker
from coral.contact.scene.geometry import quaternion_of, rotation_of
from coral.contact.scene.observation import BodyState

Array = NDArray[np.float64]


class Followed:
    """A tracker for every object.

    Args:
        trackers: By the object's name in pictures.
        smoothing: Share of the last velocity in the new one: 0 takes differences as they are.
    """

    def __init__(self, trackers: Mapping[str, PoseTracker], smoothing: float = 0.5) -> None:
        self._trackers, self._smoothing = dict(trackers), smoothing
        self.estimates: dict[str, PoseEstimate] = {}
        self._bodies: dict[str, BodyState] = {}
        self._seen_s: dict[str, float] = {}

    def update(self, frame: RgbdFrame) -> dict[str, BodyState]:
        """Where everything is in a new picture.

        While an object is lost it is reported at rest where it was last seen, and its estimate says that it is lost.
        """
        for name, tracker in self._trackers.items():
            mask = frame.mask(name)
            known = name in self._bodies
            estimate = tracker.track(frame, mask) if known else tracker.register(frame, mask)
            self.estimates[name] = estimate
            self._bodies[name] = self._body(name, estimate, frame.time_s)
        return dict(self._bodies)

    @property
    def lost(self) -> dict[str, str]:
        """Why objects are lost, by name; empty when all are followed."""
        return {name: estimate.reason for name, estimate in self.estimates.items() if estimate.lost}

    def _body(self, name: str, estimate: PoseEstimate, time_s: float) -> BodyState:
        T = estimate.T_world_object
        position, turn = T[:3, 3].copy(), T[:3, :3]
        before, seen_s = self._bodies.get(name), self._seen_s.get(name)
        if estimate.lost:
            self._seen_s.pop(name, None)
        else:
            self._seen_s[name] = time_s
        if estimate.lost or estimate.registered or before is None or seen_s is None or time_s <= seen_s:
            return BodyState(position, quaternion_of(turn))
        step, keep = time_s - seen_s, self._smoothing
        spin = vector(turn @ rotation_of(before.quaternion).T) / step
        speed = (position - before.position) / step
        return BodyState(
            position,
            quaternion_of(turn),
            keep * before.velocity + (1 - keep) * speed,
            keep * before.angular_velocity + (1 - keep) * spin,
        )
