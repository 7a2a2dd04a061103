"""Signed distance from points to ground outlines."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.world.scene import Footprints

_ELLIPSE = 0


@njit(cache=True)
def ellipse_distance(x: float, y: float, a: float, b: float) -> float:
    """Compute the signed distance from (x, y) to the ellipse with half-axes a, b along the axes, centred at 0.

    With a >= b and the point in the first quadrant, the closest point is (a^2 x / (t + a^2), b^2 y / (t + b^2)) for the
    largest root t of g(t) = (a x / (t + a^2))^2 + (b y / (t + b^2))^2 - 1. g is decreasing and convex right of -b^2, so
    Newton's method from a point left of the root converges without overshooting.
    """
    if a == b:
        return math.sqrt(x * x + y * y) - a
    x, y = abs(x), abs(y)
    if a < b:
        a, b, x, y = b, a, y, x
    if y < 1e-12 * b:
        # On the long axis, inside the centre of curvature, there are two closest points, off the axis.
        focal = (a * a - b * b) / a
        if x < focal:
            cx = a * x / focal
            return -b * math.sqrt(max(0.0, 1.0 - (cx / a) ** 2 + ((cx - x) / b) ** 2))
        return x - a
    # At either start one term of g is at least 1, so the root lies to the right.
    t = max(-b * b + b * y, -a * a + a * x)
    for _ in range(100):
        u, w = a * x / (t + a * a), b * y / (t + b * b)
        g = u * u + w * w - 1.0
        slope = 2.0 * (u * u / (t + a * a) + w * w / (t + b * b))
        step = g / slope
        t += step
        if step <= 1e-15 * (abs(t) + b * b):
            break
    ex, ey = a * a * x / (t + a * a), b * b * y / (t + b * b)
    distance = math.sqrt((x - ex) ** 2 + (y - ey) ** 2)
    return distance if t > 0.0 else -distance


@njit(cache=True)
def rectangle_distance(x: float, y: float, a: float, b: float) -> float:
    """Compute the signed distance from (x, y) to the rectangle |x| <= a, |y| <= b."""
    dx, dy = abs(x) - a, abs(y) - b
    if dx > 0.0 and dy > 0.0:
        return math.sqrt(dx * dx + dy * dy)
    return max(dx, dy)


@njit(cache=True)
def outline_distance(
    x: float,
    y: float,
    k: int,
    outlines: Footprints,
) -> float:
    """Compute the signed distance (m) from a world point to outline k, negative inside."""
    kind, center, half, yaw = outlines
    dx, dy = x - center[k, 0], y - center[k, 1]
    c, s = math.cos(yaw[k]), math.sin(yaw[k])
    px, py = c * dx + s * dy, -s * dx + c * dy
    if kind[k] == _ELLIPSE:
        return ellipse_distance(px, py, half[k, 0], half[k, 1])
    return rectangle_distance(px, py, half[k, 0], half[k, 1])


@njit(cache=True)
def distances_along(track: NDArray[np.float64], reach_m: float, outlines: Footprints) -> NDArray[np.float64]:
    """Compute the signed distances (m) from points, Shape=(N, 2), to K outlines, inf beyond `reach_m`. Shape=(N, K)."""
    kind, center, half, _ = outlines
    found = np.full((track.shape[0], kind.size), np.inf)
    for i in range(track.shape[0]):
        x, y = track[i, 0], track[i, 1]
        for k in range(kind.size):
            dx, dy = x - center[k, 0], y - center[k, 1]
            reach = half[k, 0] + half[k, 1] + reach_m
            if dx * dx + dy * dy <= reach * reach:
                found[i, k] = outline_distance(x, y, k, outlines)
    return found
