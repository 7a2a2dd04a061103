"""The surfaces of a reef: the sea floor with its ripples, gravel and debris, and what solids are made of.

All of them sample noise tiles, which is inlined.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

TILE_PX = 512
"""Edge of the finest level of a noise tile (texels)."""
FAST = {"contract", "arcp", "afn", "nsz", "reassoc"}
"""Without the flags that let the compiler forget infinity, which is the depth of open water."""
_TEXELS = TILE_PX * TILE_PX
SAND = (0.50, 0.44, 0.34)
"""Reflectance of quartz sand with some shell, darkened by being wet."""
RIPPLE_M = 0.17
"""Distance between the crests of ripples; waves make them from 0.1 to 0.3 m apart in shallow water."""
SHELL, ROCK, PILE, BLOCK, BUOY, CARD = range(6)
"""Materials: an oyster's shell, a rock, a wooden pile, a concrete block, a painted ball, an even gray card."""


@njit(cache=True, error_model="numpy", fastmath=FAST)
def sample_tile(
    tile: NDArray[np.uint8], x: float, y: float, period: float, span: float
) -> tuple[float, float, float, float]:
    """Sample a tile of edge `period` (m) for a pixel that covers `span` (m): bilinear, on the level nearest to it."""
    wide = span * TILE_PX / period
    level = 0
    while wide > 1.414 and level < 9:
        wide *= 0.5
        level += 1
    n = TILE_PX >> level
    start = (4 * _TEXELS - 4 * n * n) // 3
    a, b = x / period * n, y / period * n
    fa, fb = math.floor(a), math.floor(b)
    j, i = int(fa), int(fb)
    a, b = a - fa, b - fb
    i0, i1, j0, j1 = (i & (n - 1)) * n, ((i + 1) & (n - 1)) * n, j & (n - 1), (j + 1) & (n - 1)
    k00, k01, k10, k11 = start + i0 + j0, start + i0 + j1, start + i1 + j0, start + i1 + j1
    unit = 1.0 / 255.0
    w00, w01 = unit * (1.0 - a) * (1.0 - b), unit * a * (1.0 - b)
    w10, w11 = unit * (1.0 - a) * b, unit * a * b
    return (
        w00 * tile[k00, 0] + w01 * tile[k01, 0] + w10 * tile[k10, 0] + w11 * tile[k11, 0],
        w00 * tile[k00, 1] + w01 * tile[k01, 1] + w10 * tile[k10, 1] + w11 * tile[k11, 1],
        w00 * tile[k00, 2] + w01 * tile[k01, 2] + w10 * tile[k10, 2] + w11 * tile[k11, 2],
        w00 * tile[k00, 3] + w01 * tile[k01, 3] + w10 * tile[k10, 3] + w11 * tile[k11, 3],
    )


@njit(cache=True, error_model="numpy", fastmath=FAST)
def smooth_step(low: float, high: float, x: float) -> float:
    """Rise smoothly from 0 at `low` to 1 at `high`."""
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


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


@njit(cache=True, error_model="numpy", fastmath=FAST)
def solid_surface(
    dx: float,
    dy: float,
    dz: float,
    span: float,
    kind: int,
    half: NDArray[np.float64],
    turn: NDArray[np.float64],
    material: int,
    paint: NDArray[np.float64],
    fate: NDArray[np.float64],
    tile: NDArray[np.uint8],
) -> tuple[float, float, float, float, float, float, float]:
    """Return reflectance, normal and share of the sky that is seen, of a point on a solid."""
    # The point in the solid's own axes, in metres and as a share of the half-extents.
    lx = turn[0, 0] * dx + turn[1, 0] * dy + turn[2, 0] * dz
    ly = turn[0, 1] * dx + turn[1, 1] * dy + turn[2, 1] * dz
    lz = turn[0, 2] * dx + turn[1, 2] * dy + turn[2, 2] * dz
    ex, ey, ez = lx / half[0], ly / half[1], lz / half[2]
    if kind == 0:
        mx, my, mz = ex / half[0], ey / half[1], ez / half[2]
    elif kind == 1:
        ax, ay, az = abs(ex), abs(ey), abs(ez)
        mx = math.copysign(1.0, ex) if ax >= ay and ax >= az else 0.0
        my = math.copysign(1.0, ey) if mx == 0.0 and ay >= az else 0.0
        mz = math.copysign(1.0, ez) if mx == 0.0 and my == 0.0 else 0.0
    else:
        side = math.sqrt(ex * ex + ey * ey) >= abs(ez)
        mx, my, mz = (ex, ey, 0.0) if side else (0.0, 0.0, math.copysign(1.0, ez))
    norm = 1.0 / math.sqrt(mx * mx + my * my + mz * mz)
    mx, my, mz = mx * norm, my * norm, mz * norm
    red, green, blue, sky = paint[0], paint[1], paint[2], 1.0
    if material == SHELL:
        red, green, blue, mx, my, mz, sky = shell_surface(lx, ly, ex, ey, ez, mx, my, mz, span, half, paint, fate, tile)
    elif material != CARD:
        # The tile is laid on along the axis that the surface faces most, at a place of its own.
        if material == PILE:
            su, sv = math.atan2(ey, ex) * half[0], 0.3 * lz
        elif abs(mz) > 0.7:
            su, sv = lx, ly
        elif abs(mx) > abs(my):
            su, sv = ly, lz
        else:
            su, sv = lx, lz
        su, sv = su + 5.0 * fate[0], sv + 5.0 * fate[1]
        cloud, grain, flake, pebble = sample_tile(tile, su, sv, 1.3, span)
        if material == ROCK:
            coarse, _, _, _ = sample_tile(tile, sv, su, 3.1, span)
            shadeful = (
                0.35 + 0.75 * cloud + 0.5 * (grain - 0.5) + 0.4 * (coarse - 0.5) - 0.25 * smooth_step(0.3, 0.7, pebble)
            )
            mx, my, mz = mx + 0.7 * (cloud - 0.5), my + 0.7 * (coarse - 0.5), mz + 0.4 * (grain - 0.5)
        elif material == PILE:
            shadeful = 0.45 + 0.8 * cloud + 0.7 * (grain - 0.5)
            mx, my = mx + 0.4 * (grain - 0.5), my - 0.4 * (grain - 0.5)
        elif material == BLOCK:
            shadeful = 0.7 + 0.4 * cloud + 0.35 * (grain - 0.5) - 0.35 * smooth_step(0.5, 0.8, pebble)
            mx, my, mz = mx + 0.25 * (grain - 0.5), my + 0.25 * (cloud - 0.5), mz + 0.2 * (grain - 0.5)
        else:
            shadeful = 0.9 + 0.2 * (cloud - 0.5)
        red, green, blue = red * shadeful, green * shadeful, blue * shadeful
        if material != BUOY:
            # Barnacles below, a film of algae where light falls.
            lime = smooth_step(0.45, 0.6, flake) * smooth_step(0.5, 0.62, cloud + 0.3 * (0.5 - 0.5 * ez) * fate[2])
            red, green, blue = red + lime * (0.42 - red), green + lime * (0.40 - green), blue + lime * (0.34 - blue)
            algae = 0.75 * smooth_step(0.42, 0.68, 0.55 * grain + 0.45 * cloud + 0.12 * mz) * fate[3]
            red, green, blue = red + algae * (0.07 - red), green + algae * (0.11 - green), blue + algae * (0.04 - blue)
        norm = 1.0 / math.sqrt(mx * mx + my * my + mz * mz)
        mx, my, mz = mx * norm, my * norm, mz * norm
    nx = turn[0, 0] * mx + turn[0, 1] * my + turn[0, 2] * mz
    ny = turn[1, 0] * mx + turn[1, 1] * my + turn[1, 2] * mz
    nz = turn[2, 0] * mx + turn[2, 1] * my + turn[2, 2] * mz
    return max(red, 0.01), max(green, 0.01), max(blue, 0.01), nx, ny, nz, sky


@njit(cache=True, error_model="numpy", fastmath=FAST)
def shell_surface(
    lx: float,
    ly: float,
    ex: float,
    ey: float,
    ez: float,
    mx: float,
    my: float,
    mz: float,
    span: float,
    half: NDArray[np.float64],
    paint: NDArray[np.float64],
    fate: NDArray[np.float64],
    tile: NDArray[np.uint8],
) -> tuple[float, float, float, float, float, float, float]:
    """Return reflectance, normal and sky of an oyster: frilled growth rings around the hinge at one end."""
    cloud, grain, _, _ = sample_tile(tile, lx + 3.0 * fate[0], ly + 3.0 * fate[1] + 0.5 * half[2] * ez, 0.45, span)
    hinge = -1.0 if fate[2] < 0.5 else 1.0
    ax, ay = ex + hinge * 1.05, ey * (0.75 + 0.3 * fate[3])
    away = math.sqrt(ax * ax + ay * ay) + 1e-6
    rings = 5.0 + 4.0 * fate[3]
    turns = rings * (away + 0.28 * (cloud - 0.5) + 0.06 * math.sin(9.0 * math.atan2(ay, ax) + 6.0 * fate[0]))
    part = turns - math.floor(turns)
    # A ring is a step: it rises slowly from the hinge and breaks off at its rim.
    fade = smooth_step(0.7, 0.25, span * rings / (2.0 * half[0]))
    rim = smooth_step(0.72, 0.95, part)
    step = fade * (rim * 1.15 - 0.25 * (1.0 - rim))
    mx += step * ax / away + 0.5 * (grain - 0.5)
    my += step * ay / away + 0.5 * (cloud - 0.5)
    norm = 1.0 / math.sqrt(mx * mx + my * my + mz * mz)
    bright = (
        0.72 + 0.45 * (cloud - 0.5) + 0.5 * (grain - 0.5) + fade * (0.42 * rim - 0.22 * smooth_step(0.12, 0.0, part))
    )
    red, green, blue = paint[0] * bright, paint[1] * bright, paint[2] * bright
    # The growing lip is pale; old shell near the hinge is worn and stained.
    lip = smooth_step(1.55, 2.0, away) * (0.5 + 0.5 * fate[1])
    red, green, blue = (
        red + lip * (0.55 - red) * 0.6,
        green + lip * (0.53 - green) * 0.6,
        blue + lip * (0.46 - blue) * 0.6,
    )
    stain = 0.75 * smooth_step(0.45, 0.72, 0.6 * cloud + 0.4 * grain + 0.14 * (fate[0] - 0.5)) * (1.0 - lip)
    red, green, blue = red + stain * (0.11 - red), green + stain * (0.115 - green), blue + stain * (0.06 - blue)
    sky = 0.55 + 0.45 * smooth_step(-0.6, 0.6, mz * ez)
    return max(red, 0.015), max(green, 0.015), max(blue, 0.012), mx * norm, my * norm, mz * norm, sky
