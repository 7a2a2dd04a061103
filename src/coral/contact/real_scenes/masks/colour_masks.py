"""Masks by colour: each object has a region of hue, saturation and value."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
from pydantic import BaseModel, Field

from coral.config import Fraction, read_model
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.object_model import ObjectModel
from coral.contact.real_scenes.masks.mask_source import Mask, clean_mask
from coral.contact.scene.observation import Array
from coral.contact.scene.trial import Trial
from coral.errors import InputError

Degrees = Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]
HUE_DEG, SATURATION = 12.0, 0.07
"""How far the colours of a picture are from the paint: light changes value, and hardly hue and saturation."""
GREY = 0.08
"""Paint with less saturation has no hue."""


class ColourRegion(BaseModel, frozen=True, extra="forbid"):
    """A region of colours."""

    hue_deg: tuple[Degrees, Degrees] = (0.0, 360.0)
    """First and last hue, upwards: red is (350, 10)."""
    saturation: tuple[Fraction, Fraction] = (0.0, 1.0)
    """Least and largest; 0 is grey."""
    value: tuple[Fraction, Fraction] = (0.1, 1.0)
    """Least and largest; 0 is black."""

    def contains(self, hsv: Array) -> Mask:
        """Return which colours lie in it. Shape=(...) for Shape=(..., 3)."""
        low, high = self.hue_deg
        wide = high - low if abs(high - low) >= 360.0 else (high - low) % 360.0
        inside = (hsv[..., 0] - low) % 360.0 <= wide
        for k, (least, largest) in enumerate((self.saturation, self.value), 1):
            inside &= (hsv[..., k] >= least) & (hsv[..., k] <= largest)
        return np.asarray(inside)


class ColoursFile(BaseModel, frozen=True, extra="forbid"):
    """The region of each object."""

    objects: Annotated[dict[str, ColourRegion], Field(min_length=1)]


class ColourMasks:
    """Takes the pixels of an object's colour; of several patches the largest.

    For simple objects and for tests: two objects of one colour, or a hand of an object's colour, are not distinguished.
    """

    def __init__(self, regions: Mapping[str, ColourRegion]) -> None:
        self.regions = dict(regions)

    def segment(self, frame: RgbdFrame, poses: Mapping[str, Array]) -> Mapping[str, Mask]:
        """See `MaskSource.segment`."""
        hsv = hue_saturation_value(frame)
        return {name: clean_mask(region.contains(hsv)) for name, region in self.regions.items()}


def paint_regions(paint: Mapping[str, tuple[float, float, float]], where: str) -> dict[str, ColourRegion]:
    """Return the regions of objects whose paint is known: red, green, blue, 0 to 1; `where` is its source, for errors.

    Raises:
        InputError: Two objects have the same colour.
    """
    regions: dict[str, ColourRegion] = {}
    for name, colour in paint.items():
        hue, saturation, _ = colorsys.rgb_to_hsv(*colour)
        hue *= 360.0
        same = [other for other, region in regions.items() if region.contains(np.array([hue, saturation, 0.5]))]
        if same:
            expected = f"another colour than that of {same[0]}, or --masks colour:FILE with measured ones"
            raise InputError(where, name, "the same colour", expected)
        regions[name] = ColourRegion(
            hue_deg=(0.0, 360.0) if saturation < GREY else (round(hue - HUE_DEG, 1), round(hue + HUE_DEG, 1)),
            saturation=(round(max(0.0, saturation - SATURATION), 3), round(min(1.0, saturation + SATURATION), 3)),
        )
    return regions


def make_colour_masks(file: str, trial: Trial, models: Mapping[str, ObjectModel]) -> ColourMasks:
    """Make the masks of a trial's objects, by the colours of a file, or of the task if it is "".

    Raises:
        InputError: The file is missing, broken or lacks an object, or there is none and objects have the same colour.
    """
    if not file:
        return ColourMasks(paint_regions({name: trial.task.object(name).color for name in models}, trial.task.name))
    regions = read_model(Path(file), ColoursFile).objects
    for name in models:
        if name not in regions:
            raise InputError(file, f"objects.{name}", "missing", f"an entry for each object: {', '.join(models)}")
    return ColourMasks({name: regions[name] for name in models})


def hue_saturation_value(frame: RgbdFrame) -> Array:
    """Convert a picture to hue (degrees), saturation and value (0 to 1), Shape=(H, W, 3).

    Raises:
        InputError: It has no colours.
    """
    if frame.rgb is None:
        raise InputError("--masks", "", "a picture without colours", "a camera or recording with colours")
    return np.asarray(cv2.cvtColor(frame.rgb.astype(np.float32) / 255.0, cv2.COLOR_RGB2HSV), float)
