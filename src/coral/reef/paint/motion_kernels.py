"""Motion blur: what each pixel sees while the shutter is open."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

TAPS = 5


@njit(cache=True, error_model="numpy")
def blur_motion(
    focal: float,
    p: NDArray[np.float64],
    q: NDArray[np.float64],
    shift: NDArray[np.float64],
    turn: NDArray[np.float64],
    depth: NDArray[np.float32],
    source: NDArray[np.float32],
    image: NDArray[np.float32],
) -> None:
    """Average the picture along the way of every point during the exposure: P' = -V - W x P.

    Args:
        focal: Focal length (px).
        p: Shape=(W,), (u - cx) / fx of every column.
        q: Shape=(H,), (v - cy) / fy of every row.
        shift: Shape=(3,), V, way of the camera during the exposure, in its own frame (m).
        turn: Shape=(3,), W, rotation of the camera during the exposure, in its own frame (rad).
        depth: Shape=(H, W) (m), inf where nothing is seen.
        source: Shape=(H, W, 3).
        image: Shape=(H, W, 3), written.
    """
    height, width = depth.shape
    for v in range(height):
        for u in range(width):
            near = 1.0 / depth[v, u]
            # Velocity of the point, divided by its depth.
            x = -shift[0] * near - (turn[1] - turn[2] * q[v])
            y = -shift[1] * near - (turn[2] * p[u] - turn[0])
            z = -shift[2] * near - (turn[0] * q[v] - turn[1] * p[u])
            du, dv = focal * (x - p[u] * z), focal * (y - q[v] * z)
            size = math.sqrt(du * du + dv * dv)
            if size < 0.3:
                for k in range(3):
                    image[v, u, k] = source[v, u, k]
                continue
            scale = min(size, 24.0) / size
            red, green, blue = 0.0, 0.0, 0.0
            for tap in range(TAPS):
                share = scale * (tap / (TAPS - 1) - 0.5)
                a, b = u + share * du, v + share * dv
                a, b = min(max(a, 0.0), width - 1.001), min(max(b, 0.0), height - 1.001)
                j, i = int(a), int(b)
                a, b = a - j, b - i
                w00, w01, w10, w11 = (1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b
                for k in range(3):
                    value = w00 * source[i, j, k] + w01 * source[i, j + 1, k]
                    value += w10 * source[i + 1, j, k] + w11 * source[i + 1, j + 1, k]
                    if k == 0:
                        red += value
                    elif k == 1:
                        green += value
                    else:
                        blue += value
            image[v, u, 0], image[v, u, 1], image[v, u, 2] = red / TAPS, green / TAPS, blue / TAPS
