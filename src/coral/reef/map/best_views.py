"""The best colour picture of each cluster: the nearest one that shows it whole, kept until a better one comes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.chain import Track
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Frame, Pose

SAME_M = 1.0
"""A view within this of a cluster is of it."""
BETTER = 0.85
"""A new picture replaces the old one from this share of its distance."""
NEAR_M = 1.2
"""From nearer, a picture shows only a part."""
HEIGHT_M = 0.15
"""Middle of a cluster above the floor."""
HALF_M = 0.95
"""Half of the width of water that a crop shows."""
HIDDEN_M = 1.0
"""What is this much nearer than a cluster hides it."""
TICK_S = 0.1


@dataclass(frozen=True)
class View:
    """One picture of a cluster."""

    x: float
    y: float
    """Place of the cluster (m)."""
    distance_m: float
    taken: int
    """Tick of the picture."""
    take: Callable[[], NDArray[np.uint8]]
    """Returns the whole colour picture. Shape=(H, W, 3)."""
    at: tuple[float, float, float]
    """Where it is in the picture, and half of the crop's width, as shares of the picture's width."""

    @cached_property
    def crop(self) -> NDArray[np.uint8]:
        """The part of the picture that shows the cluster. Shape=(N, M, 3)."""
        whole = self.take()
        height, width = whole.shape[:2]
        u, v, half = (width * share for share in self.at)
        top, bottom = max(int(v - half), 0), min(math.ceil(v + half), height)
        begin, end = max(int(u - half), 0), min(math.ceil(u + half), width)
        return whole[top:bottom, begin:end]


class BestViews:
    """Keeps the best view of each cluster."""

    def __init__(self, camera: CameraCfg) -> None:
        self._camera = camera
        self.views: tuple[View, ...] = ()
        self._tick = 0

    def update(self, frame: Frame, pose: Pose, tracks: Sequence[Track], tick: int) -> None:
        """Take in a picture taken from a pose."""
        self._tick = tick
        picture = frame.rgb
        take = frame.still or (None if picture is None else lambda: picture)
        if take is None:
            return
        camera = self._camera
        fx, fy, cx, cy = camera.intrinsics
        world_camera = T_world_camera(pose, camera)
        for track in tracks:
            x, y, z = world_camera[:3, :3].T @ (np.array([track.x, track.y, HEIGHT_M]) - world_camera[:3, 3])
            u, v = (cx + fx * x / z, cy + fy * y / z) if z > 0.3 else (-1.0, -1.0)
            if not (0.1 * camera.width < u < 0.9 * camera.width and 0.0 <= v < 0.95 * camera.height):
                continue
            if float(frame.depth[int(v), int(u)]) < z - HIDDEN_M:
                continue
            distance = math.dist((pose.x, pose.y), (track.x, track.y))
            old = next((view for view in self.views if _same(view, track)), None)
            if old is not None and not NEAR_M <= distance <= BETTER * old.distance_m:
                continue
            at = float(u) / camera.width, float(v) / camera.width, min(fx * HALF_M / float(z) / camera.width, 0.5)
            view = View(track.x, track.y, distance, tick, take, at)
            self.views = (*(other for other in self.views if other is not old), view)

    def of(self, tracks: Sequence[Track]) -> list[tuple[Track, View, float]]:
        """Return the best view of each cluster that has one, and its age (s)."""
        found = [(track, next((view for view in self.views if _same(view, track)), None)) for track in tracks]
        return [(track, view, TICK_S * (self._tick - view.taken)) for track, view in found if view is not None]


def _same(view: View, track: Track) -> bool:
    return math.dist((view.x, view.y), (track.x, track.y)) <= SAME_M
