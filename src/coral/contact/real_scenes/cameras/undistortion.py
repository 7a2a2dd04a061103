"""Pictures without the distortion of their lens."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.observation import Array


class Undistortion:
    """Removes the distortion of a lens, after Brown and Conrady or a fisheye's: each pixel is looked up where it fell.

    The nearest pixel is taken, since an average of two depths is the depth of nothing.

    The coefficients are k1, k2, p1, p2, k3 ..., as OpenCV orders them; with `fisheye` k1 to k4 of an equidistant lens,
    which bends even where they are 0. `inverse`: they map distorted to undistorted places (librealsense's
    `inverse_brown_conrady`) instead of the reverse.
    """

    def __init__(
        self, lens: Array, coefficients: Array, size: tuple[int, int], *, inverse: bool = False, fisheye: bool = False
    ) -> None:
        self.lens = lens
        self._map: NDArray[np.float32] | None = None
        if not (fisheye or np.any(coefficients)):
            return
        height, width = size
        fx, fy, cx, cy = lens
        matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
        if inverse:
            u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
            grid = np.stack([u, v], axis=-1).reshape(-1, 1, 2)
            found = cv2.undistortPoints(grid, matrix, coefficients, P=matrix).reshape(height, width, 2)
        else:
            prepare: Any = cv2.fisheye.initUndistortRectifyMap if fisheye else cv2.initUndistortRectifyMap
            found = np.dstack(prepare(matrix, coefficients, np.eye(3), matrix, (width, height), cv2.CV_32FC1))
        self._map = np.asarray(found, np.float32)

    def apply(self, picture: NDArray[Any]) -> NDArray[Any]:
        """Remove the distortion from a picture, Shape=(H, W) or (H, W, 3); what the lens did not see is 0."""
        if self._map is None:
            return picture
        return np.asarray(cv2.remap(picture, self._map[..., 0], self._map[..., 1], cv2.INTER_NEAREST))
