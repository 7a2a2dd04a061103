"""The surface of the sea floor: rippled sand, silt, gravel, and the debris of shells."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.paint.texture_kernels import FAST, sample_tile, smooth_step

SAND = (0.50, 0.44, 0.34)
"""Reflectance of quartz sand with some shell, darkened by being wet."""
RIPPLE_M = 0.17
"""Distance between the crests of ripples; waves make them from 0.1 to 0.3 m apart in shallow water."""


@njit(cache=True, error_model="numpy", fastmath=FAST)
def floor_surface(
    x: float,
    y: float,
    span: float,
    debris: float,
    sand: tuple[float, float, float],
    tile: NDArray[np.uint8],
) -> tuple[float, float, float, float, float, float]:
    """Return reflectance (red, green, blue) and normal of a point of the sea floor.

    `span` is what the pixel covers there (m), `debris` the density of shell debris, 0 to 1; `tile` as `noise_tile`.
    """
    # The same tile at three scales, turned against one another so that no repetition shows.
    wide, wide_grain, _, _ = sample_tile(tile, 0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, 9.7, span)
    middle, middle_grain, _, pebble = sample_tile(tile, 0.96 * x + 0.28 * y, 0.96 * y - 0.28 * x, 2.3, span)
    _, grain, flake, _ = sample_tile(tile, x, y, 1.1, span)
    tilt_x = 0.35 * (middle_grain - 0.5) + 0.3 * (grain - 0.5)
    tilt_y = 0.35 * (wide_grain - 0.5) - 0.3 * (grain - 0.5)
    bright = 0.76 + 0.62 * wide + 0.4 * (middle - 0.5) + 0.7 * (grain - 0.5)
    # Ripples: rows that bend with the noise and die out in patches and under debris.
    fade = smooth_step(0.5, 0.2, span / RIPPLE_M) * smooth_step(0.34, 0.52, wide + 0.4 * (middle - 0.5))
    fade *= 1.0 - 0.8 * debris
    if fade > 0.01:
        phase = 2.0 * math.pi / RIPPLE_M * (0.34 * x + 0.94 * y + 0.45 * wide + 0.12 * middle)
        rise = math.sin(phase)
        # Crests sharper than troughs; fine dark matter gathers in the troughs.
        slope = 0.5 * fade * math.cos(phase) * (0.8 + 0.35 * rise)
        tilt_x += 0.34 * slope
        tilt_y += 0.94 * slope
        bright -= 0.14 * fade * (0.5 - 0.5 * rise)
    norm = 1.0 / math.sqrt(1.0 + tilt_x * tilt_x + tilt_y * tilt_y)
    silt = smooth_step(0.52, 0.75, 1.0 - wide + 0.6 * (0.5 - middle))
    red, green, blue = (
        sand[0] * bright * (1.0 - 0.42 * silt),
        sand[1] * bright * (1.0 - 0.35 * silt),
        sand[2] * bright * (1.0 - 0.32 * silt),
    )
    gravel = smooth_step(0.35, 0.55, pebble) * smooth_step(0.54, 0.36, wide)
    stone = 0.08 + 0.22 * pebble * (0.5 + grain)
    red, green = red + gravel * (1.1 * stone - red), green + gravel * (stone - green)
    blue += gravel * (0.9 * stone - blue)
    # Fewer bits away from the reef; between them the mud that a reef gathers.
    mud = 0.35 * debris
    red, green, blue = red * (1.0 - mud), green * (1.0 - 0.92 * mud), blue * (1.0 - 0.95 * mud)
    bit = (0.05 + 0.95 * debris) * smooth_step(0.36, 0.6, flake)
    pale = 0.18 + 0.42 * flake * (0.7 + 0.6 * (middle_grain - 0.5))
    red, green, blue = red + bit * (pale - red), green + bit * (0.95 * pale - green), blue + bit * (0.84 * pale - blue)
    return max(red, 0.02), max(green, 0.02), max(blue, 0.015), -tilt_x * norm, -tilt_y * norm, norm
