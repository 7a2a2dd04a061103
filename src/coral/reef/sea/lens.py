"""The lens of a recorded camera, and pictures as a camera without its distortion would have taken them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.vehicle.camera import CameraCfg

DistortionModel = Literal["plumb_bob", "rational_polynomial", "equidistant"]
COEFFICIENTS: dict[str, tuple[int, ...]] = {
    "plumb_bob": (0, 4, 5),
    "rational_polynomial": (0, 8, 12, 14),
    "equidistant": (4,),
}
"""Numbers of coefficients of each model, named as in sensor_msgs/CameraInfo; equidistant is OpenCV's fisheye."""
WIDEST_DEG = 120.0
"""Widest horizontal field of view of a rectified picture: beyond it a plane picture stretches its edges more than
fourfold, and no network here is trained on it."""
LARGEST_WIDTH = 1280
"""Larger pictures are reduced to this width (px): over 90 degrees its pixels are 1.6 mm wide at 1 m, finer than any
product needs."""
_ALIKE = 1e-3
"""Relative difference of focal lengths, and largest coefficient, that make no difference."""
_OFF_CENTRE_PX = 1.0
_MOST_PIXELS = 20_000
"""Widest and highest picture that is believed (px)."""


@dataclass(frozen=True, kw_only=True)
class Lens:
    """A calibrated camera: OpenCV's pinhole or fisheye model. Integer pixels are pixel centres."""

    width: int
    height: int
    """Of the pictures in the recording (px)."""
    fx: float
    fy: float
    cx: float
    cy: float
    """Focal lengths and principal point (px)."""
    model: DistortionModel = "plumb_bob"
    distortion: tuple[float, ...] = ()
    """Coefficients of the model, in OpenCV's order; none for a rectified picture."""

    @property
    def is_plain(self) -> bool:
        """Whether pictures need no rectification: square pixels, principal point in the middle, no distortion."""
        return (
            self.model != "equidistant"
            and max(map(abs, self.distortion), default=0.0) <= _ALIKE
            and abs(self.fx - self.fy) <= _ALIKE * self.fx
            and abs(self.cx - (self.width - 1) / 2) <= _OFF_CENTRE_PX
            and abs(self.cy - (self.height - 1) / 2) <= _OFF_CENTRE_PX
        )

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The camera matrix. Shape=(3, 3)."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def slopes(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return X / Z and Y / Z of the rays through points of the picture (px). Shape=(N, 2) to (N, 2)."""
        given = points.reshape(-1, 1, 2)
        undistort: Any = cv2.fisheye.undistortPoints if self.model == "equidistant" else cv2.undistortPoints
        return np.asarray(undistort(given, self.matrix, np.array(self.distortion or (0.0,) * 4)), np.float64).reshape(
            -1, 2
        )


def check_lens(lens: Lens, where: str) -> Lens:
    """Return a lens that can be used.

    Raises:
        InputError: A value is out of range.
    """
    if not (2 <= lens.width <= _MOST_PIXELS and 2 <= lens.height <= _MOST_PIXELS):
        raise InputError(where, "width, height", f"{lens.width} x {lens.height}", f"pixels, 2 to {_MOST_PIXELS} each")
    for name, value in (("fx", lens.fx), ("fy", lens.fy)):
        if not 0.0 < value < math.inf:
            raise InputError(where, name, value, "a focal length above 0 px")
    for name, value, edge in (("cx", lens.cx, lens.width), ("cy", lens.cy, lens.height)):
        if not 0.0 <= value < edge:
            raise InputError(where, name, value, f"a principal point within the {edge} pixels of the picture")
    if lens.model not in COEFFICIENTS:
        raise InputError(where, "model", repr(lens.model), f"one of {', '.join(COEFFICIENTS)}")
    if len(lens.distortion) not in COEFFICIENTS[lens.model] or not np.isfinite(lens.distortion).all():
        counts = " or ".join(str(n) for n in COEFFICIENTS[lens.model])
        raise InputError(where, "distortion", list(lens.distortion), f"{counts} finite numbers for {lens.model}")
    return lens


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
    if not lens.width * down / across <= _MOST_PIXELS:
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
