"""What all masks have in common: one connected patch without speckles, and colours that do not depend on light."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.errors import InputError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
SECOND_PART = 0.2
"""Parts of a mask with a smaller share of its largest part are dropped: a finger in front splits an object in two."""
_SPECKLE = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))


def clean_mask(mask: Mask) -> Mask:
    """Remove speckles, and keep the largest connected part with those of similar size."""
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, _SPECKLE)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(opened, connectivity=4)
    if count < 2:
        return np.zeros(mask.shape, bool)
    areas = stats[:, cv2.CC_STAT_AREA].copy()
    areas[0] = 0
    return np.asarray(np.isin(labels, np.flatnonzero(areas >= max(1, SECOND_PART * areas.max()))))


def hue_saturation_value(frame: RgbdFrame) -> Array:
    """Convert a picture to hue (degrees), saturation and value (0 to 1), Shape=(H, W, 3).

    Raises:
        InputError: It has no colours.
    """
    if frame.rgb is None:
        raise InputError("--masks", "", "a picture without colours", "a camera or recording with colours")
    return np.asarray(cv2.cvtColor(frame.rgb.astype(np.float32) / 255.0, cv2.COLOR_RGB2HSV), float)
