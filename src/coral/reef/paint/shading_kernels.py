"""Light that leaves every surface of a picture towards the camera, before any water lies between."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.paint.surface_kernels import FAST, floor_surface, solid_surface
from coral.reef.world.scene import SceneSolids


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def shade(
    pose: NDArray[np.float64],
    seabed_z: float,
    p: NDArray[np.float64],
    q: NDArray[np.float64],
    pixel: float,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    floor: NDArray[np.bool_],
    solids: SceneSolids,
    material: NDArray[np.uint8],
    paint: NDArray[np.float64],
    fate: NDArray[np.float64],
    tile: NDArray[np.uint8],
    ground: NDArray[np.uint8],
    ground_frame: tuple[float, float, float],
    waves: NDArray[np.float32],
    waves_m: float,
    contrast: float,
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
        solids: N of them.
        material: Shape=(N,), a constant of `surface_kernels`.
        paint: Shape=(N, 3), reflectance of each solid.
        fate: Shape=(N, 4), random numbers of each solid, 0 to 1.
        tile: Shape=(M, 4), as `noise_tile`.
        ground: Shape=(NY, NX, 3), as `SeaFloor.values`.
        ground_frame: Origin (x, y) and cell of the ground (m).
        waves: Shape=(n, n), caustics now, relative to their mean; n is a power of two.
        waves_m: Edge of their tile (m).
        contrast: What is left of theirs, 0 to 1.
        sun: Unit vector towards the sun, under water.
        sun_light: Irradiance of the sun on a surface that faces it, at the sea floor, divided by pi.
        sky_light: Irradiance from all other directions above, at the sea floor, divided by pi.
        diffuse: Attenuation of daylight on its way down (1/m).
        sand: Reflectance of the sand.
        image: Shape=(H, W, 3), written: radiance.
    """
    kind, center, half, rotation, _ = solids
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
            bounce = 0.0
            if i < 0:
                seen_sun, seen_sky, debris = _ground(x, y, ground, ground_frame)
                slant = math.sqrt(length / max(-rz, 0.02))
                red, green, blue, nx, ny, nz = floor_surface(x, y, span * slant, debris, sand, tile)
                h = 0.0
            else:
                red, green, blue, nx, ny, nz, seen_sky = solid_surface(
                    x - center[i, 0], y - center[i, 1], h + seabed_z - center[i, 2], span,
                    kind[i], half[i], rotation[i], material[i], paint[i], fate[i], tile,
                )  # fmt: skip
                # Near the floor a solid stands in its own corner; the floor sends back part of the light it gets.
                seen_sky *= 0.45 + 0.55 * min(1.0, h / (0.5 * half[i, 0] + 0.05))
                seen_sun = 1.0
                bounce = 0.12 * (1.0 - nz)
                if h > 0.02:
                    red, green = red * math.exp(diffuse[0] * h), green * math.exp(diffuse[1] * h)
                    blue *= math.exp(diffuse[2] * h)
            cosine = nx * sun[0] + ny * sun[1] + nz * sun[2]
            direct = 0.0
            if cosine > 0.0 and seen_sun > 0.0:
                away = h / sun[2]
                focus = 1.0 + contrast * (_focus(x - away * sun[0], y - away * sun[1], waves, waves_m) - 1.0)
                direct = cosine * seen_sun * focus
            ambient = seen_sky * (0.58 + 0.42 * nz) + bounce
            image[v, u, 0] = red * (sun_light[0] * direct + sky_light[0] * ambient)
            image[v, u, 1] = green * (sun_light[1] * direct + sky_light[1] * ambient)
            image[v, u, 2] = blue * (sun_light[2] * direct + sky_light[2] * ambient)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _ground(
    x: float, y: float, ground: NDArray[np.uint8], frame: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return the shares of sun and sky that reach a point of the sea floor, and the debris there."""
    a, b = (x - frame[0]) / frame[2], (y - frame[1]) / frame[2]
    ny, nx = ground.shape[:2]
    if not (0.0 <= a < nx - 1 and 0.0 <= b < ny - 1):
        return 1.0, 1.0, 0.0
    j, i = int(a), int(b)
    a, b = a - j, b - i
    unit = 1.0 / 255.0
    w00, w01 = unit * (1.0 - a) * (1.0 - b), unit * a * (1.0 - b)
    w10, w11 = unit * (1.0 - a) * b, unit * a * b
    return (
        w00 * ground[i, j, 0] + w01 * ground[i, j + 1, 0] + w10 * ground[i + 1, j, 0] + w11 * ground[i + 1, j + 1, 0],
        w00 * ground[i, j, 1] + w01 * ground[i, j + 1, 1] + w10 * ground[i + 1, j, 1] + w11 * ground[i + 1, j + 1, 1],
        w00 * ground[i, j, 2] + w01 * ground[i, j + 1, 2] + w10 * ground[i + 1, j, 2] + w11 * ground[i + 1, j + 1, 2],
    )


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _focus(x: float, y: float, waves: NDArray[np.float32], edge: float) -> float:
    """Sample the caustics between their texels."""
    n = waves.shape[0]
    a, b = x / edge * n, y / edge * n
    fa, fb = math.floor(a), math.floor(b)
    j, i = int(fa), int(fb)
    a, b = a - fa, b - fb
    i0, i1, j0, j1 = i & (n - 1), (i + 1) & (n - 1), j & (n - 1), (j + 1) & (n - 1)
    return float(
        (1.0 - b) * ((1.0 - a) * waves[i0, j0] + a * waves[i0, j1])
        + b * ((1.0 - a) * waves[i1, j0] + a * waves[i1, j1])
    )
