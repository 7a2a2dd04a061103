"""Colours of a ray-cast picture: Lambert's law with a headlight and a lamp above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.observation import Array

_AMBIENT, _HEADLIGHT, _LAMP = 0.3, 0.4, 0.3
"""Shares of the light; their sum is 1, so that nothing is overexposed."""
_SKY = np.array([191, 209, 230], np.uint8)


def shade(normal: Array, solid: NDArray[np.int64], colour: Array, lens: Array) -> NDArray[np.uint8]:
    """Shade a picture and return RGB, Shape=(H, W, 3).

    The unit normals, Shape=(H, W, 3), are in the camera frame, 0 without a surface; `solid` is the index into `colour`,
    Shape=(N, 3), from 0 to 1, -1 without a surface; the lens is fx, fy, cx, cy in pixels.
    """
    height, width = solid.shape
    rows, columns = np.nonzero(solid >= 0)
    p, q = (columns - lens[2]) / lens[0], (rows - lens[3]) / lens[1]
    n = normal[rows, columns]
    headlight = -(n[:, 0] * p + n[:, 1] * q + n[:, 2]) / np.sqrt(1.0 + p * p + q * q)
    light = (255.0 * (_AMBIENT + _HEADLIGHT * headlight.clip(0.0) + _LAMP * (-n[:, 1]).clip(0.0))).astype(np.float32)
    picture = np.broadcast_to(_SKY, (height, width, 3)).copy()
    picture[rows, columns] = (colour.astype(np.float32)[solid[rows, columns]] * light[:, None] + 0.5).astype(np.uint8)
    return picture
