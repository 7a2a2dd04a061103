"""The orthomosaic: the sea floor from above, put together from pictures taken at a slant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction, Positive
from coral.reef.pictures.floor_mosaic import FloorMosaic
from coral.reef.products.seen_points import grid_shape, transform_of
from coral.reef.recordings.recording import Recording
from coral.reef.world.geometry import Frame, Label

CLASS_COLOURS = {
    Label.WATER: (20, 60, 90),
    Label.OYSTER: (64, 160, 92),
    Label.OBSTACLE: (70, 72, 78),
    Label.SEABED: (205, 188, 150),
}
"""Red, green, blue of classes where people look at them."""


@dataclass(frozen=True, kw_only=True)
class MosaicCfg:
    """The orthomosaic's pixels."""

    pixel_m: Positive = 0.02
    """Edge of a pixel of the mosaic."""
    range_m: Positive = 4.0
    """Largest distance of a picture that gives a colour (m)."""
    shade_share: Fraction = 0.05
    """Structures larger than this share of a picture's width are shade: the mean of all pictures. 0: each point has the
    colour of one picture, with seams."""


@dataclass(frozen=True)
class Mosaic:
    """The sea floor from above."""

    rgba: NDArray[np.uint8]
    """Shape=(MY, MX, 4), row 0 in the south; transparent where nothing was seen."""
    pixel_m: float
    colour: bool
    """False: class colours, since the recording has no colour pictures."""


def make_mosaic(recording: Recording, cfg: MosaicCfg) -> Mosaic:
    """Put the pictures of a located recording together; see `FloorMosaic`. Colours are those of the water."""
    mosaic = FloorMosaic(grid_shape(recording, cfg.pixel_m), cfg.pixel_m, recording.camera, cfg.range_m)
    colour = False
    for keyframe in recording.keyframes():
        frame = keyframe.frame
        picture = colours_of(frame)
        if frame.rgb is not None:
            colour = True
        share = cfg.shade_share if frame.rgb is not None else 0.0
        mosaic.add(picture, frame.depth, transform_of(keyframe, recording), share)
    return Mosaic(mosaic.rgba, cfg.pixel_m, colour)


def colours_of(frame: Frame) -> NDArray[np.uint8]:
    """Return the colour picture, or the classes in colours, darker with distance. Shape=(H, W, 3)."""
    if frame.rgb is not None:
        return frame.rgb
    table = np.array([CLASS_COLOURS[label] for label in Label], np.float32)
    shade = np.where(np.isfinite(frame.depth), np.clip(1.1 - 0.08 * frame.depth, 0.5, 1.0), 1.0)
    return (table[frame.labels] * shade[:, :, None]).astype(np.uint8)
