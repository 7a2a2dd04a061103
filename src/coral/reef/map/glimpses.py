"""Colour pictures of the way, spaced so that few of them show the whole floor that was passed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Frame, Pose, wrap

MOST = 24
"""Pictures that are kept: the memory and the time of a mosaic are bounded by it."""
APART_M, TURN_RAD = 2.5, math.radians(50.0)
"""A picture is kept if no other was taken this near to it in about this direction."""
PICTURE_PX = 480
"""Width of a kept picture."""


@dataclass(frozen=True)
class Glimpse:
    """One picture of the way."""

    pose: Pose
    depth: NDArray[np.float32]
    """Shape=(H, W), m."""
    take: Callable[[], NDArray[np.uint8]]
    """Returns the whole colour picture. Shape=(H, W, 3)."""

    @cached_property
    def picture(self) -> NDArray[np.uint8]:
        """The colour picture, `PICTURE_PX` wide. Shape=(H, W, 3)."""
        whole = self.take()
        size = (PICTURE_PX, round(PICTURE_PX * whole.shape[0] / whole.shape[1]))
        return np.asarray(cv2.resize(whole, size, interpolation=cv2.INTER_AREA), np.uint8)


class Glimpses:
    """Keeps pictures of the way."""

    def __init__(self) -> None:
        self.kept: tuple[Glimpse, ...] = ()

    def update(self, frame: Frame, pose: Pose) -> None:
        """Take in a picture taken from a pose."""
        rgb = frame.rgb
        take = frame.still or (None if rgb is None else lambda: rgb)
        if take is None or any(_apart(pose, one.pose) < 1.0 for one in self.kept):
            return
        self.kept = (*self.kept, Glimpse(pose, frame.depth, take))
        if len(self.kept) > MOST:  # the one that others make up for best
            nearest = [min(_apart(a.pose, b.pose) for b in self.kept if b is not a) for a in self.kept]
            dropped = nearest.index(min(nearest))
            self.kept = self.kept[:dropped] + self.kept[dropped + 1 :]


def _apart(a: Pose, b: Pose) -> float:
    """Return how much two poses differ: 1 where the second picture is worth keeping."""
    return math.dist(a[:2], b[:2]) / APART_M + abs(wrap(a.theta - b.theta)) / TURN_RAD
