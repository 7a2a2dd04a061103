"""Light and shell debris on the sea floor around solids, rasterised once for a scene."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.world.scene import SceneSolids

_ELLIPSOID, _BOX = 0, 1


@njit(cache=True, error_model="numpy")
def rasterise_ground(
    origin: tuple[float, float, float],
    cell: float,
    sun: tuple[float, float, float],
    softness: float,
    solids: SceneSolids,
    shell: NDArray[np.bool_],
    ground: NDArray[np.float32],
) -> None:
    """Write for every cell how much sun and sky it sees, and how much shell debris lies there.

    Args:
        origin: World position of the middle of cell (0, 0), on the sea floor (m).
        cell: Edge of a cell (m).
        sun: Unit vector towards the sun, under water.
        softness: Width of a shadow's edge as a share of the distance to what casts it.
        solids: N of them.
        shell: Shape=(N,), whether debris lies around the solid.
        ground: Shape=(NY, NX, 3), begun with (1, 1, 0); multiplied by what remains of sun and sky, debris added.
    """
    kind, center, half, rotation, _ = solids
    ny, nx = ground.shape[:2]
    x0, y0, z0 = origin
    lean_x, lean_y = sun[0] / sun[2], sun[1] / sun[2]
    for i in range(kind.size):
        size = max(half[i, 0], half[i, 1], half[i, 2])
        low, high = center[i, 2] - z0 - size, center[i, 2] - z0 + size
        if high <= 0.0:
            continue
        girth = max(half[i, 0], half[i, 1])
        near = 0.9 if shell[i] else 0.5 + girth
        reach = size + near
        tall = max(high, 0.0)
        left = center[i, 0] - reach - max(lean_x * tall, 0.0)
        right = center[i, 0] + reach - min(lean_x * tall, 0.0)
        lower = center[i, 1] - reach - max(lean_y * tall, 0.0)
        upper = center[i, 1] + reach - min(lean_y * tall, 0.0)
        for j in range(max(int((lower - y0) / cell), 0), min(int((upper - y0) / cell) + 1, ny)):
            for k in range(max(int((left - x0) / cell), 0), min(int((right - x0) / cell) + 1, nx)):
                dx, dy, dz = x0 + k * cell - center[i, 0], y0 + j * cell - center[i, 1], z0 - center[i, 2]
                gap, along = _miss(kind[i], dx, dy, dz, sun, half[i], rotation[i])
                edge = 0.01 + softness * along
                lit = min(max(0.5 + 0.5 * gap / edge, 0.0), 1.0)
                ground[j, k, 0] *= lit * lit * (3.0 - 2.0 * lit)
                e0 = (rotation[i, 0, 0] * dx + rotation[i, 1, 0] * dy) / half[i, 0]
                e1 = (rotation[i, 0, 1] * dx + rotation[i, 1, 1] * dy) / half[i, 1]
                beside = max(math.sqrt(e0 * e0 + e1 * e1) - 1.0, 0.0) * girth
                above = max(low, 0.0)
                reaches = 0.4 * (high - above) + 0.02
                ground[j, k, 1] *= 1.0 - 0.65 * math.exp(-beside / reaches - above / (girth + 0.01))
                if shell[i]:
                    ground[j, k, 2] += 0.3 * math.exp(-0.5 * (beside / 0.22) ** 2)


@njit(cache=True, error_model="numpy")
def _miss(
    kind: int,
    dx: float,
    dy: float,
    dz: float,
    sun: tuple[float, float, float],
    half: NDArray[np.float64],
    turn: NDArray[np.float64],
) -> tuple[float, float]:
    """Return by how much the ray towards the sun misses a solid (m, negative inside), and after what way (m)."""
    e0 = (turn[0, 0] * dx + turn[1, 0] * dy + turn[2, 0] * dz) / half[0]
    e1 = (turn[0, 1] * dx + turn[1, 1] * dy + turn[2, 1] * dz) / half[1]
    e2 = (turn[0, 2] * dx + turn[1, 2] * dy + turn[2, 2] * dz) / half[2]
    g0 = (turn[0, 0] * sun[0] + turn[1, 0] * sun[1] + turn[2, 0] * sun[2]) / half[0]
    g1 = (turn[0, 1] * sun[0] + turn[1, 1] * sun[1] + turn[2, 1] * sun[2]) / half[1]
    g2 = (turn[0, 2] * sun[0] + turn[1, 2] * sun[1] + turn[2, 2] * sun[2]) / half[2]
    width = min(half[0], half[1])
    if kind == _ELLIPSOID:
        t = max(-(e0 * g0 + e1 * g1 + e2 * g2) / (g0 * g0 + g1 * g1 + g2 * g2), 0.0)
        a, b, c = e0 + t * g0, e1 + t * g1, e2 + t * g2
        return (math.sqrt(a * a + b * b + c * c) - 1.0) * min(width, half[2]), t
    # Boxes and cylinders are upright: the part of the ray between bottom and top, then the nearest point to the axis.
    enter, leave = max((-1.0 - e2) / g2, 0.0), max((1.0 - e2) / g2, 0.0)
    if kind == _BOX:
        for _ in range(24):
            first, second = enter + (leave - enter) / 3.0, leave - (leave - enter) / 3.0
            a = max(abs(e0 + first * g0), abs(e1 + first * g1))
            b = max(abs(e0 + second * g0), abs(e1 + second * g1))
            if a < b:
                leave = second
            else:
                enter = first
        t = 0.5 * (enter + leave)
        return (max(abs(e0 + t * g0), abs(e1 + t * g1)) - 1.0) * width, t
    square = g0 * g0 + g1 * g1
    t = -(e0 * g0 + e1 * g1) / square if square > 1e-12 else enter
    t = min(max(t, enter), leave)
    return (math.hypot(e0 + t * g0, e1 + t * g1) - 1.0) * width, t
