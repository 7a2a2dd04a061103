"""What eyes are: a picture in; classes, metric depth and their doubt out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label

UNSTATED_DOUBT = 0.3
"""Doubt of what a network says without a probability."""


@dataclass(frozen=True)
class SeenPicture:
    """What eyes make of a picture."""

    labels: NDArray[np.uint8]
    """`Label` of every pixel. Shape=(H, W)."""
    depth: NDArray[np.float32]
    """Depth along the optical axis (m); inf for water. Shape=(H, W)."""
    doubt: NDArray[np.float32]
    """Probability that the label is wrong, 0 to 1. Shape=(H, W)."""
    unlike: float = 0.0
    """How far the picture is from all that the network was trained on; at 1 or more nobody should judge by it."""


@dataclass(frozen=True)
class CameraAttitude:
    """Where the camera is, outside the plane."""

    height: float | None = None
    """Above the sea floor (m); None: as configured."""
    roll: float = 0.0
    """As for `T_world_camera` (rad)."""
    pitch: float = 0.0
    """As for `T_world_camera` (rad)."""
    echoes: NDArray[np.float32] | None = field(default=None, compare=False)
    """Column, row (px) and depth (m) of what a sonar hears in the picture; None without a sonar. Shape=(N, 3)."""


class RgbPerception(Protocol):
    """Eyes."""

    about: tuple[str, ...]
    """What they take their network for, line by line: layout, classes, pictures."""

    def perceive(self, rgb: NDArray[np.uint8], camera: CameraCfg, attitude: CameraAttitude) -> SeenPicture:
        """Find classes and depth in an sRGB picture, Shape=(H, W, 3), taken by a camera in a measured attitude."""


def perceive_frame(frame: Frame, eyes: RgbPerception, camera: CameraCfg, attitude: CameraAttitude) -> Frame:
    """Replace the depth and the classes of a frame by what eyes see in its colours; nothing of the truth remains.

    Oysters and sea floor of a picture unlike all that the network knows are doubted entirely: they are no evidence for
    anything. Its obstacles stay.

    Raises:
        ValueError: The frame has no colours.
    """
    if frame.rgb is None:
        raise ValueError("the frame has no colours")
    seen = eyes.perceive(frame.rgb, camera, attitude)
    unseen = (seen.labels == Label.WATER) | ~np.isfinite(seen.depth)
    doubt = seen.doubt
    if seen.unlike >= 1.0:
        judged = (seen.labels == Label.OYSTER) | (seen.labels == Label.SEABED)
        doubt = np.where(judged, np.float32(1.0), doubt).astype(np.float32)
    return replace(
        frame,
        depth=np.where(unseen, np.float32(np.inf), seen.depth).astype(np.float32),
        labels=np.where(unseen, np.uint8(Label.WATER), seen.labels).astype(np.uint8),
        instances=np.full(seen.labels.shape, -1, np.int32),
        doubt=doubt,
    )


def is_judged(frame: Frame) -> bool:
    """Check whether a frame's oysters and sea floor may be evidence: `perceive_frame` doubts all of them otherwise."""
    if frame.doubt is None:
        return True
    ground = (frame.labels == Label.OYSTER) | (frame.labels == Label.SEABED)
    return not ground.any() or bool((frame.doubt[ground] < 1.0).any())
