"""Pictures of a lens as a camera without its distortion would have taken them."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.lens import MOST_PIXELS, Lens
from coral.reef.vehicle.camera import CameraCfg

WIDEST_DEG = 120.0
"""Widest horizontal field of view of a rectified picture: beyond it a plane picture stretches its edges more than
fourfold, and no network here is trained on it."""
LARGEST_WIDTH = 1280
"""Larger pictures are reduced to this width (px): over 90 degrees its pixels are 1.6 mm wide at 1 m, finer than any
product needs."""


def rectified_size(lens: Lens, where: str, most_width: int = LARGEST_WIDTH) -> tuple[int, int, float]:
    """Return width, height (px) and horizontal field of view (degrees) of pictures after rectification.

    The view is the largest symmetric one whose edges the picture still reaches in the middle of each side. Wider
    pictures than `most_width` (px) are reduced.

    Raises:
        InputError: The picture does not reach both sides of its optical axis.
    """
    if lens.is_plain:
        width = min(lens.width, most_width)
        fov = math.degrees(2.0 * math.atan(0.5 * lens.width / lens.fx))
        return width, round(lens.height * width / lens.width), round(fov, 9)
    right, bottom = lens.width - 0.5, lens.height - 0.5
    edges = lens.slopes(np.array([[-0.5, lens.cy], [right, lens.cy], [lens.cx, -0.5], [lens.cx, bottom]], np.float64))
    across = min(-edges[0, 0], edges[1, 0], math.tan(math.radians(WIDEST_DEG / 2)))
    down = min(-edges[2, 1], edges[3, 1])
    if not (0.05 < across < math.inf and 0.05 < down < math.inf):
        raise InputError(where, "distortion", list(lens.distortion), "a lens whose picture reaches all four sides")
    if not lens.width * down / across <= MOST_PIXELS:
        raise InputError(where, "fx, fy", f"{lens.fx:g} and {lens.fy:g}", "focal lengths of one camera, nearly equal")
    width = min(lens.width, most_width)
    return width, max(round(width * down / across), 2), round(math.degrees(2.0 * math.atan(across)), 9)


class Rectifier:
    """Turns pictures of a lens into those of a pinhole camera with square pixels, by looking pixels up."""

    def __init__(self, lens: Lens, view: CameraCfg) -> None:
        """Prepare the maps from a recording's lens to a view of the same direction."""
        self._size = view.width, view.height
        # At the resolution of the recording: reducing comes after, averaging over pixels.
        self._fine = max(lens.width / view.width, 1.0)
        width, height = round(view.width * self._fine), round(view.height * self._fine)
        focal, _, _, _ = view.intrinsics
        focal *= width / view.width
        matrix = np.array([[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]])
        prepare: Any = (
            cv2.fisheye.initUndistortRectifyMap if lens.model == "equidistant" else cv2.initUndistortRectifyMap
        )
        coefficients = np.array(lens.distortion or (0.0,) * 4)
        self._u, self._v = prepare(lens.matrix, coefficients, np.eye(3), matrix, (width, height), cv2.CV_32FC1)
        self.outside: NDArray[np.bool_] = self._look_up(np.ones((lens.height, lens.width), np.uint8), nearest=True) == 0
        """Pixels of the result that the lens does not show. Shape=(H, W)."""

    def colours(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return a colour picture, black where the lens shows nothing. Shape=(H, W, 3)."""
        return np.asarray(self._look_up(rgb, nearest=False), np.uint8)

    def values(self, image: NDArray[Any]) -> NDArray[Any]:
        """Return a picture of values that must not be mixed, such as classes; 0 outside. Shape=(H, W)."""
        return self._look_up(image, nearest=True)

    def _look_up(self, image: NDArray[Any], *, nearest: bool) -> NDArray[Any]:
        how = cv2.INTER_NEAREST if nearest else cv2.INTER_LINEAR
        looked = cv2.remap(image, self._u, self._v, how, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
        if (looked.shape[1], looked.shape[0]) != self._size:
            looked = cv2.resize(looked, self._size, interpolation=cv2.INTER_NEAREST if nearest else cv2.INTER_AREA)
        return np.ascontiguousarray(looked)
