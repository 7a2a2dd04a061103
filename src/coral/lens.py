"""A calibrated lens: pinhole or fisheye, its distortion, and what of it can be used."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError

DistortionModel = Literal["plumb_bob", "rational_polynomial", "equidistant"]
COEFFICIENTS: dict[str, tuple[int, ...]] = {
    "plumb_bob": (0, 4, 5),
    "rational_polynomial": (0, 8, 12, 14),
    "equidistant": (0, 4),
}
"""Numbers of coefficients of each model, named as in sensor_msgs/CameraInfo; equidistant is OpenCV's fisheye."""
_ALIKE = 1e-3
"""Relative difference of focal lengths, and largest coefficient, that make no difference."""
_OFF_CENTRE_PX = 1.0
MOST_PIXELS = 20_000
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
    if not (2 <= lens.width <= MOST_PIXELS and 2 <= lens.height <= MOST_PIXELS):
        raise InputError(where, "width, height", f"{lens.width} x {lens.height}", f"pixels, 2 to {MOST_PIXELS} each")
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
