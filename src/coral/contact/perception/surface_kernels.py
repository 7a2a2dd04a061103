"""Distances from points to triangles."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, error_model="numpy")
def distance(points: NDArray[np.float64], triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute distances (m) of points, Shape=(n, 3), to the nearest of triangles, Shape=(m, 3, 3).

    Source: Ericson, Real-Time Collision Detection, 5.1.5.
    """
    found = np.empty(len(points))
    for i in range(len(points)):
        best = np.inf
        for k in range(len(triangles)):
            best = min(best, _square(points[i], triangles[k]))
        found[i] = np.sqrt(best)
    return found


@njit(cache=True, error_model="numpy")
def _square(point: NDArray[np.float64], triangle: NDArray[np.float64]) -> float:
    """Compute the squared distance of one point to one triangle."""
    ab0, ab1, ab2 = triangle[1, 0] - triangle[0, 0], triangle[1, 1] - triangle[0, 1], triangle[1, 2] - triangle[0, 2]
    ac0, ac1, ac2 = triangle[2, 0] - triangle[0, 0], triangle[2, 1] - triangle[0, 1], triangle[2, 2] - triangle[0, 2]
    ap0, ap1, ap2 = point[0] - triangle[0, 0], point[1] - triangle[0, 1], point[2] - triangle[0, 2]
    a, b, c = ab0 * ab0 + ab1 * ab1 + ab2 * ab2, ab0 * ac0 + ab1 * ac1 + ab2 * ac2, ac0 * ac0 + ac1 * ac1 + ac2 * ac2
    d, e = ab0 * ap0 + ab1 * ap1 + ab2 * ap2, ac0 * ap0 + ac1 * ap1 + ac2 * ap2
    volume = a * c - b * b
    if volume > 1e-30:
        s, t = (c * d - b * e) / volume, (a * e - b * d) / volume
        if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
            return _gap(ap0, ap1, ap2, ab0, ab1, ab2, ac0, ac1, ac2, s, t)
    s = min(1.0, max(0.0, d / a)) if a > 0.0 else 0.0
    t = min(1.0, max(0.0, e / c)) if c > 0.0 else 0.0
    f = a - 2.0 * b + c
    r = min(1.0, max(0.0, (a - b - d + e) / f)) if f > 0.0 else 0.0
    best = min(
        _gap(ap0, ap1, ap2, ab0, ab1, ab2, ac0, ac1, ac2, s, 0.0),
        _gap(ap0, ap1, ap2, ab0, ab1, ab2, ac0, ac1, ac2, 0.0, t),
    )
    return min(best, _gap(ap0, ap1, ap2, ab0, ab1, ab2, ac0, ac1, ac2, 1.0 - r, r))


@njit(cache=True, error_model="numpy", inline="always")
def _gap(
    ap0: float,
    ap1: float,
    ap2: float,
    ab0: float,
    ab1: float,
    ab2: float,
    ac0: float,
    ac1: float,
    ac2: float,
    s: float,
    t: float,
) -> float:
    x, y, z = ap0 - s * ab0 - t * ac0, ap1 - s * ab1 - t * ac1, ap2 - s * ab2 - t * ac2
    return x * x + y * y + z * z
