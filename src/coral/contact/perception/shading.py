"""Colours of a ray-cast picture: Lambert's law with a headlight and a lamp above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_AMBIENT, _HEADLIGHT, _LAMP = 0.3, 0.4, 0.3
"""Shares of the light; they sum to 1, so that nothing is overexposed."""
_SKY = np.array([0.75, 0.82, 0.9])


def shade(normal: Array, solid: NDArray[np.int64], colour: Array, lens: Array) -> NDArray[np.uint8]:
    """RGB picture, Shape=(H, W, 3).

    Args:
        normal: Shape=(H, W, 3), unit normals in the camera frame; 0 where nothing is seen.
        solid: Shape=(H, W), index into `colour`; -1 where nothing is seen.
        colour: Shape=(N, 3), from 0 to 1.
        lens: Shape=(4,): fx, fy, cx, cy in pixels.
    """
    height, width = solid.shape
    p, q = (np.arange(width) - lens[2]) / lens[0], (np.arange(height) - lens[3]) / lens[1]
    length = np.sqrt(1.0 + p[None, :] ** 2 + q[:, None] ** 2)
    headlight = -(normal[..., 0] * p[None, :] + normal[..., 1] * q[:, None] + normal[..., 2]) / length
    light = _AMBIENT + _HEADLIGHT * headlight.clip(0.0) + _LAMP * (-normal[..., 1]).clip(0.0)
    picture = np.concatenate([colour, _SKY[None]])[solid] * np.where(solid >= 0, light, 1.0)[..., None]
    return np.asarray((255.0 * picture.clip(0.0, 1.0)).round(), np.uint8)
