"""The surfaces of solids: shells, rocks, wooden piles, concrete, painted balls."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.paint.texture_kernels import FAST, sample_tile, smooth_step

SHELL, ROCK, PILE, BLOCK, BUOY, CARD = range(6)
"""Materials: an oyster's shell, a rock, a wooden pile, a concrete block, a painted ball, an even gray card."""


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
