"""Eyes for painted pictures, which say so where a picture is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from coral.reef.eyes.perception import CameraAttitude, SeenPicture
from coral.reef.eyes.reef_net import ReefNetEyes
from coral.reef.vehicle.camera import CameraCfg

NEARER = 1.05
"""Largest distance to painted reefs over that to real pictures. Of the shipped network for real ones it is 0.72 to 0.93
in the pictures of missions, and 1.7 to 2.9 in frames of two videos; while it was trained, 1.02 at most and 1.07 at
least, the latter in videos that were left out."""

FAR = 1.2
"""Largest distance to painted reefs, in units of the network's limit: it is at most 1.02 in those pictures."""


class PaintedOnlyEyes:
    """Sees by the network for painted pictures; that for real ones, which knows both, tells what is painted."""

    def __init__(self, eyes: ReefNetEyes, real: ReefNetEyes) -> None:
        """Use the two networks."""
        self.about: tuple[str, ...] = eyes.about
        self._eyes, self._real = eyes, real

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find classes and depth, and how far the picture is from painted ones."""
        from_real, from_painted = self._real.compare(rgb, camera, attitude)
        seen = self._eyes.perceive(rgb, camera, attitude)
        return replace(seen, unlike=max(from_painted / FAR, from_painted / max(NEARER * from_real, 1e-6)))
