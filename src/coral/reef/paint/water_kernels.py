"""What the water between a surface and the camera does to its light, and the light that the water adds."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.paint.surface_kernels import FAST

Rgb = tuple[float, float, float]
ANISOTROPY = 0.7
"""Mean cosine of scattering without its forward half. Petzold's whole phase function has about 0.92; the half that goes
nearly straight on counts as not scattered, as it does for `WaterType.lost`."""


@njit(cache=True, error_model="numpy", fastmath=FAST)
def transmission_table(beam: Rgb, lost: Rgb, far: float, table: NDArray[np.float32]) -> None:
    """Tabulate exp(-c r) and exp(-g r) - exp(-c r) for ranges from 0 to `far` (m): the exponentials of every pixel.

    `beam` is c, `lost` is g (1/m). `table`, Shape=(n, 6), is written: straight light in red, green, blue, then light
    astray.
    """
    for i in range(table.shape[0]):
        r = far * i / (table.shape[0] - 1)
        for k in range(3):
            straight = math.exp(-beam[k] * r)
            table[i, k], table[i, 3 + k] = straight, math.exp(-lost[k] * r) - straight


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def attenuate(
    turn: NDArray[np.float64],
    p: NDArray[np.float64],
    q: NDArray[np.float64],
    near: float,
    far: float,
    above: float,
    depth: NDArray[np.float32],
    surface: NDArray[np.float32],
    table: NDArray[np.float32],
    lost: Rgb,
    diffuse: Rgb,
    veil: Rgb,
    top: Rgb,
    sun: tuple[float, float, float],
    mix: tuple[float, float, float],
    direct: NDArray[np.float32],
    forward: NDArray[np.float32],
) -> None:
    """Split the light of every pixel into what comes straight and what comes a little astray; add the veiling light.

    Straight: J exp(-c r). Astray, scattered by a few degrees only: J (exp(-g r) - exp(-c r)), g = `lost`. Veil:
    daylight that falls with the depth, scattered once, along a ray that rises by s per metre,
    V (1 - exp(-(g - K s) r)) / (g - K s). A ray that meets the water's surface from below is mirrored: the pictures
    reach up to 37 degrees, and Snell's window begins at 42.

    Args:
        turn: Shape=(3, 3), camera optical frame to world.
        p: Shape=(W,), (u - cx) / fx of every column.
        q: Shape=(H,), (v - cy) / fy of every row.
        near: Range of the table's last row (m).
        far: Range of a ray that meets nothing (m).
        above: Water above the camera (m).
        depth: Shape=(H, W), along the optical axis (m), inf where nothing is seen.
        surface: Shape=(H, W, 3), light J that leaves the surfaces.
        table: Shape=(n, 6), as `transmission_table`.
        lost: g (1/m).
        diffuse: K (1/m).
        veil: Daylight times scattering at the camera's depth (1/m).
        top: The same just below the water's surface.
        sun: Unit vector towards the sun, under water.
        mix: Weights of sun, sky and light that was scattered before, in the veil.
        direct: Shape=(H, W, 3), written: straight light and veil.
        forward: Shape=(H, W, 3), written: light astray, still sharp.
    """
    last = table.shape[0] - 1
    for v in range(q.size):
        for u in range(p.size):
            rx = turn[0, 0] * p[u] + turn[0, 1] * q[v] + turn[0, 2]
            ry = turn[1, 0] * p[u] + turn[1, 1] * q[v] + turn[1, 2]
            rz = turn[2, 0] * p[u] + turn[2, 1] * q[v] + turn[2, 2]
            length = math.sqrt(1.0 + p[u] * p[u] + q[v] * q[v])
            rise = rz / length
            z = depth[v, u]
            seen = z < np.inf
            r = z * length if seen else far
            mirrored = not seen and rise * far > above
            if mirrored:
                r = above / rise
            # Light is scattered towards the camera by the angle between its way and the ray's.
            toward = (rx * sun[0] + ry * sun[1] + rz * sun[2]) / length
            # The sky shines through Snell's window, whose brightest part for a ray is half way to its rim.
            level = 0.479 * math.sqrt(max(1.0 - rise * rise, 0.0))
            phase = mix[0] * _henyey(toward) + mix[1] * _henyey(level + 0.878 * rise) + mix[2]
            glint = toward - 2.0 * rise * sun[2]
            back = mix[0] * _henyey(glint) + mix[1] * _henyey(level - 0.878 * rise) + mix[2]
            at = r * last / near
            i = int(at) if at < last else last - 1
            share = at - i if at < last else 1.0
            for k in range(3):
                glow = phase * veil[k] * _path(lost[k] - diffuse[k] * rise, r)
                if mirrored:
                    glow += back * top[k] * math.exp(-lost[k] * r) * _path(lost[k] + diffuse[k] * rise, far)
                if seen:
                    light = surface[v, u, k]
                    direct[v, u, k] = light * ((1.0 - share) * table[i, k] + share * table[i + 1, k]) + glow
                    forward[v, u, k] = light * ((1.0 - share) * table[i, 3 + k] + share * table[i + 1, 3 + k])
                else:
                    direct[v, u, k] = glow
                    forward[v, u, k] = 0.0


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _henyey(cosine: float) -> float:
    """Return the phase function of Henyey and Greenstein (1/sr), with the mean cosine `ANISOTROPY`."""
    x = 1.0 + ANISOTROPY * ANISOTROPY - 2.0 * ANISOTROPY * cosine
    return (1.0 - ANISOTROPY * ANISOTROPY) / (4.0 * math.pi * x * math.sqrt(x))


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _path(rate: float, r: float) -> float:
    """Return the integral of exp(-rate s) from 0 to r."""
    return (1.0 - math.exp(-rate * r)) / rate if abs(rate) * r > 1e-3 else r


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def develop(
    linear: NDArray[np.float32],
    gain: Rgb,
    corner: float,
    photons: float,
    read: float,
    seed: int,
    table: NDArray[np.uint8],
    picture: NDArray[np.uint8],
) -> None:
    """Expose the sensor: gain, dark corners, photon and read noise, the curve of sRGB.

    Args:
        linear: Shape=(H, W, 3), light that reaches the lens.
        gain: Exposure times white balance, so that 1 is white.
        corner: Share of light that is lost in the corners.
        photons: Photons of a white pixel at a gain of 1; noise grows with the square root of light.
        read: Standard deviation of the read noise, as a share of white.
        seed: Of the noise.
        table: Shape=(4096,), bytes of the curve from 0 to 1.
        picture: Shape=(H, W, 3), written.
    """
    height, width = linear.shape[:2]
    cy, cx = 0.5 * (height - 1), 0.5 * (width - 1)
    scale = 1.0 / (cx * cx + cy * cy)
    state = np.uint32(seed)
    top = table.size - 1
    for v in range(height):
        for u in range(width):
            shade = 1.0 - corner * ((u - cx) * (u - cx) + (v - cy) * (v - cy)) * scale
            for k in range(3):
                value = linear[v, u, k] * gain[k] * shade
                # A linear congruential generator with a permuted output (O'Neill, PCG, 2014).
                state = np.uint32(state * np.uint32(747796405) + np.uint32(2891336453))
                word = np.uint32(((state >> ((state >> np.uint32(28)) + np.uint32(4))) ^ state) * np.uint32(277803737))
                word = np.uint32((word >> np.uint32(22)) ^ word)
                # Four bytes add up to nearly normal noise of mean 510 and standard deviation 147.8.
                bits = (word & np.uint32(255)) + ((word >> np.uint32(8)) & np.uint32(255))
                bits += ((word >> np.uint32(16)) & np.uint32(255)) + (word >> np.uint32(24))
                draw = (np.float64(bits) - 510.0) / 147.8
                value += draw * math.sqrt(max(value, 0.0) * gain[k] / photons + read * read)
                if not value > 0.0:
                    value = 0.0
                value = min(value, 1.0)
                picture[v, u, k] = table[int(value * top + 0.5)]
