"""Distances of convex pieces over a batch of states: corners first, then alternating projections."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
SETTLED_M = 1e-5
"""The projections end when the distance falls by less."""


@njit(cache=True, error_model="numpy")
def shorten(
    best: Array,
    one_at: Array,
    one_turn: Array,
    one_half: Array,
    one_round: int,
    one_corners: Array,
    other_at: Array,
    other_turn: Array,
    other_half: Array,
    other_round: int,
    other_corners: Array,
    projections: int,
) -> None:
    """Lower `best`, Shape=(n,) m, to the distance of two pieces in every state in which that is shorter.

    Of each piece: positions, Shape=(n, 3) m, and orientations, Shape=(n, 4); half of its extents (m); `round`: 0 for a
    box, 2 for a cylinder along z, 3 for a sphere; its corners in its own axes, Shape=(m, 3) m, of a sphere its centre.
    `projections` to and fro are made at most.
    """
    radii = (one_half[0] if one_round == 3 else 0.0) + (other_half[0] if other_round == 3 else 0.0)
    size = np.sqrt((one_half**2).sum()) + np.sqrt((other_half**2).sum())
    for n in range(len(best)):
        away = np.sqrt(
            (other_at[n, 0] - one_at[n, 0]) ** 2
            + (other_at[n, 1] - one_at[n, 1]) ** 2
            + (other_at[n, 2] - one_at[n, 2]) ** 2
        )
        if away - size >= best[n]:
            continue
        first, second = _matrix(one_turn[n]), _matrix(other_turn[n])
        least = np.inf
        x, y, z = 0.0, 0.0, 0.0  # the best point of the other piece, world frame
        for k in range(len(other_corners)):
            px, py, pz = _out(second, other_at[n], other_corners[k, 0], other_corners[k, 1], other_corners[k, 2])
            qx, qy, qz = _projected(first, one_at[n], one_half, one_round, px, py, pz)
            gap = np.sqrt((px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2)
            if gap < least:
                least, x, y, z = gap, px, py, pz
        for k in range(len(one_corners)):
            px, py, pz = _out(first, one_at[n], one_corners[k, 0], one_corners[k, 1], one_corners[k, 2])
            qx, qy, qz = _projected(second, other_at[n], other_half, other_round, px, py, pz)
            gap = np.sqrt((px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2)
            if gap < least:
                least, x, y, z = gap, qx, qy, qz
        for _ in range(projections):
            px, py, pz = _projected(first, one_at[n], one_half, one_round, x, y, z)
            x, y, z = _projected(second, other_at[n], other_half, other_round, px, py, pz)
            gap = np.sqrt((px - x) ** 2 + (py - y) ** 2 + (pz - z) ** 2)
            fell, least = least - gap, min(least, gap)
            if fell < SETTLED_M:
                break
        best[n] = min(best[n], max(least - radii, 0.0))


@njit(cache=True, error_model="numpy", inline="always")
def _projected(
    turn: Array, at: Array, half: Array, round_axes: int, x: float, y: float, z: float
) -> tuple[float, float, float]:
    """Return the nearest point of a piece to a point, both in the world frame; of a sphere its centre."""
    if round_axes == 3:
        return at[0], at[1], at[2]
    dx, dy, dz = x - at[0], y - at[1], z - at[2]
    a = turn[0, 0] * dx + turn[1, 0] * dy + turn[2, 0] * dz
    b = turn[0, 1] * dx + turn[1, 1] * dy + turn[2, 1] * dz
    c = turn[0, 2] * dx + turn[1, 2] * dy + turn[2, 2] * dz
    if round_axes == 2:
        out = np.sqrt(a * a + b * b)
        if out > half[0]:
            a, b = a * half[0] / out, b * half[0] / out
    else:
        a, b = min(max(a, -half[0]), half[0]), min(max(b, -half[1]), half[1])
    return _out(turn, at, a, b, min(max(c, -half[2]), half[2]))


@njit(cache=True, error_model="numpy", inline="always")
def _out(turn: Array, at: Array, a: float, b: float, c: float) -> tuple[float, float, float]:
    """Convert a point in a piece's axes to the world frame."""
    return (
        at[0] + turn[0, 0] * a + turn[0, 1] * b + turn[0, 2] * c,
        at[1] + turn[1, 0] * a + turn[1, 1] * b + turn[1, 2] * c,
        at[2] + turn[2, 0] * a + turn[2, 1] * b + turn[2, 2] * c,
    )


@njit(cache=True, error_model="numpy")
def _matrix(q: Array) -> Array:
    """Convert a unit quaternion (w, x, y, z) to a rotation matrix."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    found = np.empty((3, 3))
    found[0, 0], found[0, 1], found[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    found[1, 0], found[1, 1], found[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    found[2, 0], found[2, 1], found[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return found
