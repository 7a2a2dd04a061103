"""Light that leaves every surface of a picture towards the camera, before any water lies between."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.eyes.noise_tiles import SIZE

SHELL, ROCK, PILE, BLOCK, BUOY, CARD = range(6)
"""Materials: an oyster's shell, a rock, a wooden pile, a concrete block, a painted ball, an even gray card."""
_TEXELS = SIZE * SIZE
_FAST = {"contract", "arcp", "afn", "nsz", "reassoc"}
"""Without the flags that would let the compiler forget infinity, which is the depth of open water."""


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def shade(
    pose: NDArray[np.float64],
    seabed_z: float,
    p: NDArray[np.float64],
    q: NDArray[np.float64],
    pixel: float,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    floor: NDArray[np.bool_],
    kind: NDArray[np.int8],
    center: NDArray[np.float64],
    half: NDArray[np.float64],
    rotation: NDArray[np.float64],
    material: NDArray[np.uint8],
    paint: NDArray[np.float64],
    fate: NDArray[np.float64],
    tile: NDArray[np.float32],
    ground: NDArray[np.float32],
    ground_frame: tuple[float, float, float],
    film: NDArray[np.float32],
    film_m: float,
    film_frame: float,
    film_gain: float,
    sun: tuple[float, float, float],
    sun_light: tuple[float, float, float],
    sky_light: tuple[float, float, float],
    diffuse: tuple[float, float, float],
    sand: tuple[float, float, float],
    image: NDArray[np.float32],
) -> None:
    """Shade every pixel that shows a surface; the others become black.

    Args:
        pose: Shape=(4, 4), camera optical frame to world.
        seabed_z: Height of the sea floor (m).
        p: Shape=(W,), (u - cx) / fx of every column.
        q: Shape=(H,), (v - cy) / fy of every row.
        pixel: Angle of a pixel (rad).
        depth: Shape=(H, W), along the optical axis (m), inf where nothing is seen.
        ids: Shape=(H, W), index of the solid, -1 elsewhere.
        floor: Shape=(H, W), whether the pixel shows the sea floor.
        kind: Shape=(N,), as `Scene.kind`.
        center: Shape=(N, 3).
        half: Shape=(N, 3).
        rotation: Shape=(N, 3, 3), object to world.
        material: Shape=(N,), one of the constants above.
        paint: Shape=(N, 3), reflectance of each solid.
        fate: Shape=(N, 4), random numbers of each solid, 0 to 1.
        tile: Shape=(M, 4), as `noise_tile`.
        ground: Shape=(NY, NX, 3), as `SeaFloor.values`.
        ground_frame: Origin (x, y) and cell of the ground (m).
        film: Shape=(F, n, n), caustics.
        film_m: Edge of the film's tile (m).
        film_frame: Number of the frame now, not whole.
        film_gain: Contrast that is left of the caustics, 0 to 1.
        sun: Unit vector towards the sun, under water.
        sun_light: Irradiance of the sun on a surface that faces it, at the sea floor.
        sky_light: Irradiance from all other directions above, at the sea floor.
        diffuse: Attenuation of daylight on its way down (1/m).
        sand: Reflectance of the sand.
        image: Shape=(H, W, 3), written: radiance.
    """
    eye_x, eye_y, eye_z = pose[0, 3], pose[1, 3], pose[2, 3]
    for v in range(q.size):
        for u in range(p.size):
            i = ids[v, u]
            if i < 0 and not floor[v, u]:
                image[v, u, 0] = image[v, u, 1] = image[v, u, 2] = 0.0
                continue
            z = depth[v, u]
            rx = pose[0, 0] * p[u] + pose[0, 1] * q[v] + pose[0, 2]
            ry = pose[1, 0] * p[u] + pose[1, 1] * q[v] + pose[1, 2]
            rz = pose[2, 0] * p[u] + pose[2, 1] * q[v] + pose[2, 2]
            x, y, h = eye_x + z * rx, eye_y + z * ry, eye_z + z * rz - seabed_z
            length = math.sqrt(rx * rx + ry * ry + rz * rz)
            span = z * length * pixel
            if i < 0:
                red, green, blue, nx, ny, nz = _floor(
                    x, y, span * math.sqrt(length / max(-rz, 0.02)), sand, tile, ground, ground_frame
                )
                seen_sun, seen_sky = _light(x, y, ground, ground_frame)
                h = 0.0
            else:
                red, green, blue, nx, ny, nz, seen_sky = _solid(
                    x - center[i, 0], y - center[i, 1], h + seabed_z - center[i, 2], span,
                    kind[i], half[i], rotation[i], material[i], paint[i], fate[i], tile,
                )  # fmt: skip
                if kind[i] != 0:
                    seen_sky *= 0.45 + 0.55 * min(1.0, h / (0.5 * half[i, 0] + 0.05))
                seen_sun = 1.0
            focus = 1.0
            cosine = nx * sun[0] + ny * sun[1] + nz * sun[2]
            direct = 0.0
            if cosine > 0.0 and seen_sun > 0.0:
                away = h / sun[2]
                focus = 1.0 + film_gain * (_focus(x - away * sun[0], y - away * sun[1], film, film_m, film_frame) - 1.0)
                direct = cosine * seen_sun * focus
            # Light from the sides and from the floor, which sends back a part of what falls on it.
            ambient = seen_sky * (0.58 + 0.42 * nz)
            bounce = 0.12 * (1.0 - nz) if i >= 0 else 0.0
            image[v, u, 0] = (
                red * math.exp(diffuse[0] * h) * (sun_light[0] * direct + sky_light[0] * (ambient + bounce))
            )
            image[v, u, 1] = (
                green * math.exp(diffuse[1] * h) * (sun_light[1] * direct + sky_light[1] * (ambient + bounce))
            )
            image[v, u, 2] = (
                blue * math.exp(diffuse[2] * h) * (sun_light[2] * direct + sky_light[2] * (ambient + bounce))
            )


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _texel(
    tile: NDArray[np.float32], x: float, y: float, period: float, span: float
) -> tuple[float, float, float, float]:
    """Sample a tile of edge `period` (m) for a pixel that covers `span` (m): bilinear, on the level nearest to it."""
    wide = span * SIZE / period
    level = 0
    while wide > 1.414 and level < 9:
        wide *= 0.5
        level += 1
    n = SIZE >> level
    start = (4 * _TEXELS - 4 * n * n) // 3
    a, b = x / period * n, y / period * n
    fa, fb = math.floor(a), math.floor(b)
    j, i = int(fa), int(fb)
    a, b = a - fa, b - fb
    i0, i1, j0, j1 = (i & (n - 1)) * n, ((i + 1) & (n - 1)) * n, j & (n - 1), (j + 1) & (n - 1)
    k00, k01, k10, k11 = start + i0 + j0, start + i0 + j1, start + i1 + j0, start + i1 + j1
    w00, w01, w10, w11 = (1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b
    return (
        w00 * tile[k00, 0] + w01 * tile[k01, 0] + w10 * tile[k10, 0] + w11 * tile[k11, 0],
        w00 * tile[k00, 1] + w01 * tile[k01, 1] + w10 * tile[k10, 1] + w11 * tile[k11, 1],
        w00 * tile[k00, 2] + w01 * tile[k01, 2] + w10 * tile[k10, 2] + w11 * tile[k11, 2],
        w00 * tile[k00, 3] + w01 * tile[k01, 3] + w10 * tile[k10, 3] + w11 * tile[k11, 3],
    )


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _step(low: float, high: float, x: float) -> float:
    """Rise smoothly from 0 at `low` to 1 at `high`."""
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _light(x: float, y: float, ground: NDArray[np.float32], frame: tuple[float, float, float]) -> tuple[float, float]:
    """Return the shares of sun and sky that reach a point of the sea floor."""
    a, b = (x - frame[0]) / frame[2], (y - frame[1]) / frame[2]
    ny, nx = ground.shape[:2]
    if not (0.0 <= a < nx - 1 and 0.0 <= b < ny - 1):
        return 1.0, 1.0
    j, i = int(a), int(b)
    a, b = a - j, b - i
    w00, w01, w10, w11 = (1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b
    return (
        w00 * ground[i, j, 0] + w01 * ground[i, j + 1, 0] + w10 * ground[i + 1, j, 0] + w11 * ground[i + 1, j + 1, 0],
        w00 * ground[i, j, 1] + w01 * ground[i, j + 1, 1] + w10 * ground[i + 1, j, 1] + w11 * ground[i + 1, j + 1, 1],
    )


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _focus(x: float, y: float, film: NDArray[np.float32], edge: float, frame: float) -> float:
    """Sample the caustics: bilinear in space, linear in time."""
    n = film.shape[1]
    a, b = x / edge * n, y / edge * n
    fa, fb = math.floor(a), math.floor(b)
    j, i = int(fa), int(fb)
    a, b = a - fa, b - fb
    i0, i1, j0, j1 = i % n, (i + 1) % n, j % n, (j + 1) % n
    first = int(frame)
    c = frame - first
    first, second = first % film.shape[0], (first + 1) % film.shape[0]
    now = (1.0 - b) * ((1.0 - a) * film[first, i0, j0] + a * film[first, i0, j1]) + b * (
        (1.0 - a) * film[first, i1, j0] + a * film[first, i1, j1]
    )
    then = (1.0 - b) * ((1.0 - a) * film[second, i0, j0] + a * film[second, i0, j1]) + b * (
        (1.0 - a) * film[second, i1, j0] + a * film[second, i1, j1]
    )
    return float((1.0 - c) * now + c * then)


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _floor(
    x: float,
    y: float,
    span: float,
    sand: tuple[float, float, float],
    tile: NDArray[np.float32],
    ground: NDArray[np.float32],
    frame: tuple[float, float, float],
) -> tuple[float, float, float, float, float, float]:
    """Return reflectance and normal of the sea floor: rippled sand, silt, gravel and the debris of shells."""
    # The same tile at three scales, turned against one another so that no repetition shows.
    wide, wide_grain, _, _ = _texel(tile, 0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, 9.7, span)
    middle, middle_grain, _, pebble = _texel(tile, 0.96 * x + 0.28 * y, 0.96 * y - 0.28 * x, 2.3, span)
    _, grain, flake, _ = _texel(tile, x, y, 1.1, span)
    # Ripples: rows that bend with the noise and die out in patches.
    length = 0.16
    phase = 2.0 * math.pi / length * (0.34 * x + 0.94 * y + 0.55 * wide + 0.1 * middle)
    fade = _step(0.5, 0.2, span / length) * _step(0.38, 0.62, wide + 0.35 * (middle - 0.5))
    slope = 0.34 * fade * math.cos(phase + 0.35 * math.sin(phase))
    tilt_x = -0.34 * slope + 0.25 * (middle_grain - 0.5) + 0.2 * (grain - 0.5)
    tilt_y = -0.94 * slope + 0.25 * (wide_grain - 0.5) - 0.2 * (grain - 0.5)
    norm = 1.0 / math.sqrt(1.0 + tilt_x * tilt_x + tilt_y * tilt_y)
    trough = 0.5 - 0.5 * math.sin(phase)
    bright = 0.62 + 0.5 * wide + 0.35 * (middle - 0.5) + 0.55 * (grain - 0.5) - 0.13 * fade * trough
    silt = _step(0.55, 0.85, 1.0 - wide + 0.5 * (0.5 - middle))
    red = sand[0] * bright * (1.0 - 0.38 * silt)
    green = sand[1] * bright * (1.0 - 0.30 * silt)
    blue = sand[2] * bright * (1.0 - 0.28 * silt)
    gravel = _step(0.42, 0.62, pebble) * _step(0.6, 0.35, wide)
    stone = 0.10 + 0.22 * pebble * (0.6 + 0.8 * grain)
    red, green, blue = (
        red + gravel * (1.1 * stone - red),
        green + gravel * (stone - green),
        blue + gravel * (0.9 * stone - blue),
    )
    a, b = (x - frame[0]) / frame[2], (y - frame[1]) / frame[2]
    inside = 0.0 <= a < ground.shape[1] - 1 and 0.0 <= b < ground.shape[0] - 1
    debris = ground[int(b), int(a), 2] if inside else 0.0
    # Fewer and smaller bits away from the reef; between them the mud that a reef gathers.
    mud = 0.45 * debris
    red, green, blue = red * (1.0 - mud), green * (1.0 - 0.92 * mud), blue * (1.0 - 0.95 * mud)
    bit = (0.04 + 0.96 * debris) * _step(0.36, 0.6, flake)
    pale = 0.30 + 0.35 * flake
    red, green, blue = red + bit * (pale - red), green + bit * (0.95 * pale - green), blue + bit * (0.84 * pale - blue)
    return max(red, 0.02), max(green, 0.02), max(blue, 0.015), tilt_x * norm, tilt_y * norm, norm


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _solid(
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
    tile: NDArray[np.float32],
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
        red, green, blue, mx, my, mz, sky = _shell(lx, ly, ex, ey, ez, mx, my, mz, span, half, paint, fate, tile)
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
        cloud, grain, flake, pebble = _texel(tile, su, sv, 1.3, span)
        if material == ROCK:
            coarse, _, _, _ = _texel(tile, sv, su, 3.1, span)
            shadeful = 0.35 + 0.75 * cloud + 0.5 * (grain - 0.5) + 0.4 * (coarse - 0.5) - 0.25 * _step(0.3, 0.7, pebble)
            mx, my, mz = mx + 0.7 * (cloud - 0.5), my + 0.7 * (coarse - 0.5), mz + 0.4 * (grain - 0.5)
        elif material == PILE:
            shadeful = 0.45 + 0.8 * cloud + 0.7 * (grain - 0.5)
            mx, my = mx + 0.4 * (grain - 0.5), my - 0.4 * (grain - 0.5)
        elif material == BLOCK:
            shadeful = 0.7 + 0.4 * cloud + 0.35 * (grain - 0.5) - 0.35 * _step(0.5, 0.8, pebble)
            mx, my, mz = mx + 0.25 * (grain - 0.5), my + 0.25 * (cloud - 0.5), mz + 0.2 * (grain - 0.5)
        else:
            shadeful = 0.9 + 0.2 * (cloud - 0.5)
        red, green, blue = red * shadeful, green * shadeful, blue * shadeful
        if material != BUOY:
            # Barnacles below, a film of algae where light falls.
            lime = _step(0.45, 0.6, flake) * _step(0.5, 0.62, cloud + 0.3 * (0.5 - 0.5 * ez) * fate[2])
            red, green, blue = red + lime * (0.42 - red), green + lime * (0.40 - green), blue + lime * (0.34 - blue)
            algae = 0.75 * _step(0.42, 0.68, 0.55 * grain + 0.45 * cloud + 0.12 * mz) * fate[3]
            red, green, blue = red + algae * (0.07 - red), green + algae * (0.11 - green), blue + algae * (0.04 - blue)
        norm = 1.0 / math.sqrt(mx * mx + my * my + mz * mz)
        mx, my, mz = mx * norm, my * norm, mz * norm
    nx = turn[0, 0] * mx + turn[0, 1] * my + turn[0, 2] * mz
    ny = turn[1, 0] * mx + turn[1, 1] * my + turn[1, 2] * mz
    nz = turn[2, 0] * mx + turn[2, 1] * my + turn[2, 2] * mz
    return max(red, 0.01), max(green, 0.01), max(blue, 0.01), nx, ny, nz, sky


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _shell(
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
    tile: NDArray[np.float32],
) -> tuple[float, float, float, float, float, float, float]:
    """Return reflectance, normal and sky of an oyster: frilled growth rings around the hinge at one end."""
    cloud, grain, _, _ = _texel(tile, lx + 3.0 * fate[0], ly + 3.0 * fate[1] + 0.5 * half[2] * ez, 0.45, span)
    hinge = -1.0 if fate[2] < 0.5 else 1.0
    ax, ay = ex + hinge * 1.05, ey * (0.75 + 0.3 * fate[3])
    away = math.sqrt(ax * ax + ay * ay) + 1e-6
    rings = 5.0 + 4.0 * fate[3]
    turns = rings * (away + 0.28 * (cloud - 0.5) + 0.06 * math.sin(9.0 * math.atan2(ay, ax) + 6.0 * fate[0]))
    part = turns - math.floor(turns)
    # A ring is a step: it rises slowly from the hinge and breaks off at its rim.
    fade = _step(0.7, 0.25, span * rings / (2.0 * half[0]))
    rim = _step(0.72, 0.95, part)
    step = fade * (rim * 1.15 - 0.25 * (1.0 - rim))
    mx += step * ax / away + 0.5 * (grain - 0.5)
    my += step * ay / away + 0.5 * (cloud - 0.5)
    norm = 1.0 / math.sqrt(mx * mx + my * my + mz * mz)
    bright = 0.72 + 0.45 * (cloud - 0.5) + 0.5 * (grain - 0.5) + fade * (0.42 * rim - 0.22 * _step(0.12, 0.0, part))
    red, green, blue = paint[0] * bright, paint[1] * bright, paint[2] * bright
    # The growing lip is pale; old shell near the hinge is worn and stained.
    lip = _step(1.55, 2.0, away) * (0.5 + 0.5 * fate[1])
    red, green, blue = (
        red + lip * (0.55 - red) * 0.6,
        green + lip * (0.53 - green) * 0.6,
        blue + lip * (0.46 - blue) * 0.6,
    )
    stain = 0.75 * _step(0.45, 0.72, 0.6 * cloud + 0.4 * grain + 0.14 * (fate[0] - 0.5)) * (1.0 - lip)
    red, green, blue = red + stain * (0.11 - red), green + stain * (0.115 - green), blue + stain * (0.06 - blue)
    sky = 0.55 + 0.45 * _step(-0.6, 0.6, mz * ez)
    return max(red, 0.015), max(green, 0.015), max(blue, 0.012), mx * norm, my * norm, mz * norm, sky
