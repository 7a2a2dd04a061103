"""The orthomosaic: the sea floor from above, put together from pictures taken at a slant."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive
from coral.reef.geometry import Frame, Label
from coral.reef.products.cover import lens_of, transform_of
from coral.reef.products.mosaic_kernels import paint
from coral.reef.recordings.recording import Recording

CLASS_COLOURS = {
    Label.WATER: (20, 60, 90),
    Label.OYSTER: (64, 160, 92),
    Label.OBSTACLE: (70, 72, 78),
    Label.SEABED: (205, 188, 150),
}
"""Colours of the classes where no colour picture was taken: red, green, blue."""


@dataclass(frozen=True, kw_only=True)
class MosaicCfg:
    """The orthomosaic's pixels."""

    pixel_m: Positive = 0.02
    """Edge of a pixel of the mosaic."""
    range_m: Positive = 4.0
    """Largest distance of a picture that gives a colour (m)."""


@dataclass(frozen=True)
class Mosaic:
    """The sea floor from above."""

    rgba: NDArray[np.uint8]
    """Shape=(MY, MX, 4), row 0 in the south; transparent where nothing was seen."""
    pixel_m: float
    colour: bool
    """False: class colours, since the recording has no colour pictures."""


def make_mosaic(recording: Recording, cfg: MosaicCfg) -> Mosaic:
    """Put the pictures of a located recording together.

    Each point of the flat sea floor takes its colour from the picture that shows it best. What stands on the floor
    leans away from the camera that saw it, as in every orthomosaic without a surface model. Colours are those of the
    water.
    """
    width, height = recording.size_m
    shape = (math.ceil(height / cfg.pixel_m - 1e-9), math.ceil(width / cfg.pixel_m - 1e-9))
    best, rgb = np.full(shape, np.inf, np.float32), np.zeros((*shape, 3), np.uint8)
    colour = False
    for keyframe in recording.keyframes():
        colour = colour or keyframe.frame.rgb is not None
        paint(
            colours_of(keyframe.frame), keyframe.frame.depth, transform_of(keyframe, recording), lens_of(recording),
            0.0, cfg.range_m, recording.camera.near_m, cfg.pixel_m, best, rgb,
        )  # fmt: skip
    alpha = np.where(np.isfinite(best), 255, 0).astype(np.uint8)
    return Mosaic(np.dstack([rgb, alpha]), cfg.pixel_m, colour)


def colours_of(frame: Frame) -> NDArray[np.uint8]:
    """Return the colour picture, or the classes in colours, darker with distance. Shape=(H, W, 3)."""
    if frame.rgb is not None:
        return frame.rgb
    table = np.array([CLASS_COLOURS[label] for label in Label], np.float32)
    shade = np.where(np.isfinite(frame.depth), np.clip(1.1 - 0.08 * frame.depth, 0.5, 1.0), 1.0)
    return (table[frame.labels] * shade[:, :, None]).astype(np.uint8)
