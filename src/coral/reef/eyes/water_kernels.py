"""What the water between a surface and the camera does to its light, and the light that the water adds."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Rgb = tuple[float, float, float]
_FAST = {"contract", "arcp", "afn", "nsz", "reassoc"}
"""Without the flags that would let the compiler forget infinity, which is the depth of open water."""


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def attenuate(
    turn: NDArray[np.float64],
    p: NDArray[np.float64],
    q: NDArray[np.float64],
    far: float,
    above: float,
    depth: NDArray[np.float32],
    surface: NDArray[np.float32],
    beam: Rgb,
    lost: Rgb,
    diffuse: Rgb,
    veil: Rgb,
    sky: Rgb,
    direct: NDArray[np.float32],
    forward: NDArray[np.float32],
) -> None:
    """Split the light of every pixel into what comes straight and what comes a little astray; add the veiling light.

    Straight: J exp(-c r). Astray, scattered by a few degrees only: J (exp(-g r) - exp(-c r)), g = `lost`. Veil:
    daylight that falls with the depth, scattered once, along a ray that rises by s per metre,
    V (1 - exp(-(g - K s) r)) / (g - K s).

    Args:
        turn: Shape=(3, 3), camera optical frame to world.
        p: Shape=(W,), (u - cx) / fx of every column.
        q: Shape=(H,), (v - cy) / fy of every row.
        far: Range of a ray that meets nothing (m).
        above: Water above the camera (m).
        depth: Shape=(H, W), along the optical axis (m), inf where nothing is seen.
        surface: Shape=(H, W, 3), light J that leaves the surfaces.
        beam: c (1/m).
        lost: g (1/m).
        diffuse: K (1/m).
        veil: V, light scattered towards the camera at the camera's depth (1/m).
        sky: Light that falls through the water's surface, just below it.
        direct: Shape=(H, W, 3), written: straight light and veil.
        forward: Shape=(H, W, 3), written: light astray, still sharp.
    """
    for v in range(q.size):
        for u in range(p.size):
            rz = turn[2, 0] * p[u] + turn[2, 1] * q[v] + turn[2, 2]
            length = math.sqrt(1.0 + p[u] * p[u] + q[v] * q[v])
            rise = rz / length
            z = depth[v, u]
            seen = z < np.inf
            r = z * length if seen else far
            through = 0.0
            if not seen and rise * far > above:
                r = above / rise
                # Snell's window: outside of it the water's surface mirrors the water.
                through = min(max((rise - 0.64) / 0.06, 0.0), 1.0)
            for k in range(3):
                g = lost[k]
                mild = math.exp(-g * r)
                rate = g - diffuse[k] * rise
                thick = abs(rate) * r > 1e-3
                glow = veil[k] * ((1.0 - math.exp(-rate * r)) / rate if thick else r)
                if seen:
                    light = surface[v, u, k]
                    straight = math.exp(-beam[k] * r)
                    direct[v, u, k] = light * straight + glow
                    forward[v, u, k] = light * (mild - straight)
                else:
                    direct[v, u, k] = glow + through * sky[k] * mild
                    forward[v, u, k] = 0.0


@njit(cache=True, error_model="numpy", fastmath=_FAST)
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
