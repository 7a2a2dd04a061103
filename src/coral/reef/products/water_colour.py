"""Takes back what a known water does to colours on the way from the sea floor to the camera."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from coral.reef.world.water_types import WaterType

MOST_GAIN = 4.0
"""Largest gain of a channel: beyond it, noise and scattered light are all that is left to be amplified."""


def undo_attenuation(
    rgb: NDArray[np.uint8], range_m: NDArray[np.float32], water: WaterType, reference_m: float = 1.0
) -> NDArray[np.uint8]:
    """Return a picture as if all of it were seen from one distance (law of Beer and Lambert, per channel).

    Linear light is multiplied by exp(g (r - r0)), g being the attenuation without forward scattering. Light that
    the water scatters into the picture stays in it: how much that is depends on the sun, which nobody has measured.

    Args:
        rgb: sRGB. Shape=(H, W, 3).
        range_m: Distance along each pixel's line of sight (m); inf where nothing is seen, which stays as it is.
            Shape=(H, W).
        water: The water.
        reference_m: r0 (m).

    Returns:
        Shape=(H, W, 3), sRGB.
    """
    away = np.where(np.isfinite(range_m), range_m - reference_m, 0.0)[:, :, None]
    gain = np.minimum(np.exp(np.array(water.lost) * away), MOST_GAIN)
    linear = _linear_table()[rgb] * gain
    return _encode(linear)


@cache
def _linear_table() -> NDArray[np.float64]:
    """Linear light of the 256 values of sRGB (IEC 61966-2-1)."""
    x = np.arange(256) / 255.0
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def _encode(linear: NDArray[np.float64]) -> NDArray[np.uint8]:
    x = np.clip(linear, 0.0, 1.0)
    curve = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.round(255.0 * curve).astype(np.uint8)
