"""How far eyes that doubt tell oysters from sea floor: the water shows in the doubt of the floor, by distance."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.camera import CameraCfg, pixel_rays, ray_lengths
from coral.reef.world.geometry import Frame, Label

ROW_M = 0.5
"""Oysters are told while a row of pixels covers at most this much of the floor, 4.8 m away with the default
camera: the smallest cluster is about as wide. Farther away networks take oysters for sea floor."""
SURE = 0.01
"""Doubt of the floor up to which oysters would show on it. The shipped network's is 0.001 to 0.003 where it finds
more than a third of an oyster's pixels, and ten times as much half a metre beyond that, in any water."""
TIMES = 2.0
"""Nor is the floor doubtful with so many times the doubt that it has where it has least: other networks doubt more."""
MOST = 0.5
"""With more than this, nothing is told."""
SHARE = 0.8
"""Of the distance at which doubt begins, so much counts: there half of an oyster's pixels are found at best, and whole
clusters in bad light, in compressed pictures, none."""
RING_M = 0.25
FARTHEST_M = 8.0
MEMORY = 0.05
"""Weight of a new picture: the doubt is that of the last two seconds."""
STEP = 2
"""Of so many rows and columns, one is enough."""
LEAST_PIXELS = 10
TINY = 1e-4
"""Added to doubt before its logarithm is taken."""


class Eyesight:
    """Keeps the doubt of the sea floor in rings about the vehicle, as the last pictures show it."""

    def __init__(self, camera: CameraCfg) -> None:
        """Set up for a camera, without any picture."""
        self._camera, self._height_m = camera, camera.altitude_m
        self._log_doubt = np.full(round(FARTHEST_M / RING_M), np.nan)

    def look(self, frame: Frame, looks: NDArray[np.float64]) -> None:
        """Take in a picture with its doubtful pixels; `looks` are those of `looks_of`."""
        if frame.doubt is None:
            return
        depth, doubt = frame.depth[::STEP, ::STEP], frame.doubt[::STEP, ::STEP]
        floor = (frame.labels[::STEP, ::STEP] == Label.SEABED) & np.isfinite(depth)
        if not floor.any():
            return
        forward, left, length = (looks[::STEP, ::STEP][floor] * depth[floor, None]).T
        away = np.hypot(forward, left)
        self._height_m = float(np.median(np.sqrt(np.maximum(length**2 - away**2, 0.0))))
        ring, rings = (away / RING_M).astype(np.int64), len(self._log_doubt)
        near = ring < rings
        pixels = np.bincount(ring[near], minlength=rings)
        total = np.bincount(ring[near], np.log(doubt[floor][near] + TINY), minlength=rings)
        seen = pixels >= LEAST_PIXELS
        new, old = total[seen] / pixels[seen], self._log_doubt[seen]
        self._log_doubt[seen] = np.where(np.isnan(old), new, old + MEMORY * (new - old))

    @property
    def reach_m(self) -> float:
        """Distance (m) up to which oysters are told from sea floor; beyond it they may be missed."""
        row_m = math.sqrt(ROW_M * self._height_m * self._camera.intrinsics[0])
        known = np.flatnonzero(~np.isnan(self._log_doubt))
        if not len(known):
            return row_m
        doubt = self._log_doubt[known]
        clear = doubt <= min(max(math.log(SURE), float(doubt.min()) + math.log(TIMES)), math.log(MOST))
        if clear[-1]:
            return row_m
        return min(row_m, SHARE * float(known[clear][-1] + 1) * RING_M) if clear.any() else 0.0


def looks_of(camera: CameraCfg, roll: float = 0.0, pitch: float = 0.0) -> NDArray[np.float64]:
    """Return how far each pixel's ray leads along the heading and to its left, and its length. Shape=(H, W, 3)."""
    looks = pixel_rays(camera, roll, pitch)
    looks[..., 2] = ray_lengths(camera)
    return looks
