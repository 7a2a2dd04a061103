"""What segments objects in pictures: the interface, the sources by name, and what all masks have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.object_model import ObjectModel
from coral.contact.scene.observation import Array
from coral.contact.scene.trial import Trial
from coral.plugins import named_plugin

Mask = NDArray[np.bool_]
MASKS = {"colour[:FILE]": "the colours of the task file, or of a file"}
"""Description of each form of the value after `--masks`, as half a sentence."""
SECOND_PART = 0.2
"""Parts of a mask with a smaller share of its largest part are dropped: a finger in front splits an object in two."""
_SPECKLE = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))


class MaskSource(Protocol):
    """Finds the pixels of known objects in one picture after the other."""

    def segment(self, frame: RgbdFrame, poses: Mapping[str, Array]) -> Mapping[str, Mask]:
        """Return the masks in a picture by name, Shape=(H, W) each; masks that it may hold itself are not read.

        `poses` holds the last T_world_object, Shape=(4, 4), of each object that is tracked; lost ones are missing, and
        so may be the masks of objects that were not found.

        Raises:
            InputError: The picture lacks colours that are needed.
        """


def make_masks(word: str, trial: Trial, models: Mapping[str, ObjectModel]) -> MaskSource:
    """Make the source of masks that a word names, NAME or NAME:REST.

    Raises:
        InputError: There is no such source, or it cannot be used for these objects.
    """
    name, _, rest = word.partition(":")
    made: MaskSource = named_plugin("coral.masks", name, "--masks")(rest, trial, models)
    return made


def clean_mask(mask: Mask) -> Mask:
    """Remove speckles, and keep the largest connected part with those of similar size."""
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, _SPECKLE)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(opened, connectivity=4)
    if count < 2:
        return np.zeros(mask.shape, bool)
    areas = stats[:, cv2.CC_STAT_AREA].copy()
    areas[0] = 0
    return np.asarray(np.isin(labels, np.flatnonzero(areas >= max(1, SECOND_PART * areas.max()))))
