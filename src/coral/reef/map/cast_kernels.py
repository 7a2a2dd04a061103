"""Exact casting of a sonar's beams against the solids of a scene."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.world.scene import SceneSolids

_ELLIPSOID, _BOX = 0, 1


@njit(cache=True, error_model="numpy")
def cast(
    eye: NDArray[np.float64],
    turn: NDArray[np.float64],
    beams: NDArray[np.float64],
    azimuth: NDArray[np.float64],
    elevation: NDArray[np.float64],
    seabed_z: float,
    surface_z: float,
    solids: SceneSolids,
    range_m: float,
    ranges: NDArray[np.float64],
    hit: NDArray[np.int32],
) -> None:
    """Find the first surface along every beam.

    A solid is tested only against the beams whose azimuth and elevation lie within those of the ball that holds it.

    Args:
        eye: Shape=(3,), position of the sonar in the world (m).
        turn: Shape=(3, 3), sonar frame (x forward, y left, z up) to world.
        beams: Shape=(H, W, 3), unit vectors in the sonar frame.
        azimuth: Shape=(W,), evenly spaced, falling (rad).
        elevation: Shape=(H,), evenly spaced, rising (rad).
        seabed_z: Height of the sea floor (m).
        surface_z: Height of the water's surface (m); inf: none.
        solids: N of them.
        range_m: Longest range (m).
        ranges: Shape=(H, W), written: range (m), inf where nothing is within `range_m`.
        hit: Shape=(H, W), written: index of the solid, -1: the sea floor, -2: nothing, -3: the surface.
    """
    kind, center, half, rotation, radius = solids
    height, width = ranges.shape
    world = np.empty((height, width, 3))
    for v in range(height):
        for u in range(width):
            for k in range(3):
                world[v, u, k] = turn[k, 0] * beams[v, u, 0] + turn[k, 1] * beams[v, u, 1] + turn[k, 2] * beams[v, u, 2]
            dz = world[v, u, 2]
            t, what = np.inf, -2
            if dz < 0.0 and seabed_z < eye[2]:
                t, what = (seabed_z - eye[2]) / dz, -1
            elif dz > 0.0 and surface_z > eye[2] and surface_z < np.inf:
                t, what = (surface_z - eye[2]) / dz, -3
            if not t <= range_m:
                t, what = np.inf, -2
            ranges[v, u] = t
            hit[v, u] = what
    step_a = (azimuth[0] - azimuth[width - 1]) / (width - 1)
    step_e = (elevation[height - 1] - elevation[0]) / (height - 1)
    o, m = np.empty(3), np.empty((3, 3))
    for i in range(kind.size):
        dx, dy, dz = center[i, 0] - eye[0], center[i, 1] - eye[1], center[i, 2] - eye[2]
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        r = radius[i]
        if not distance - r <= range_m:
            continue
        v0, v1, u0, u1 = 0, height, 0, width
        if distance > r:
            x = turn[0, 0] * dx + turn[1, 0] * dy + turn[2, 0] * dz
            y = turn[0, 1] * dx + turn[1, 1] * dy + turn[2, 1] * dz
            z = turn[0, 2] * dx + turn[1, 2] * dy + turn[2, 2] * dz
            spread = math.asin(r / distance)
            up = math.asin(min(max(z / distance, -1.0), 1.0))
            v0 = max(int(math.floor((up - spread - elevation[0]) / step_e)), 0)
            v1 = min(int(math.ceil((up + spread - elevation[0]) / step_e)) + 1, height)
            if abs(up) + spread < 0.5 * math.pi - 1e-9:
                side, aside = math.atan2(y, x), math.asin(min(math.sin(spread) / math.cos(up), 1.0))
                # The field of view is less than a full turn: a ball behind the sonar is in neither half of it.
                u0 = max(int(math.floor((azimuth[0] - side - aside) / step_a)), 0)
                u1 = min(int(math.ceil((azimuth[0] - side + aside) / step_a)) + 1, width)
                if side + aside > math.pi or side - aside < -math.pi:
                    u0, u1 = 0, width
        if v0 >= v1 or u0 >= u1:
            continue
        for j in range(3):
            scale = 1.0 / half[i, j]
            o[j] = -(rotation[i, 0, j] * dx + rotation[i, 1, j] * dy + rotation[i, 2, j] * dz) * scale
            for k in range(3):
                m[j, k] = rotation[i, k, j] * scale
        for v in range(v0, v1):
            for u in range(u0, u1):
                a, b, c = world[v, u, 0], world[v, u, 1], world[v, u, 2]
                d0 = m[0, 0] * a + m[0, 1] * b + m[0, 2] * c
                d1 = m[1, 0] * a + m[1, 1] * b + m[1, 2] * c
                d2 = m[2, 0] * a + m[2, 1] * b + m[2, 2] * c
                t = _entry(kind[i], o, d0, d1, d2)
                if t < ranges[v, u] and t <= range_m:
                    ranges[v, u] = t
                    hit[v, u] = i


@njit(cache=True, error_model="numpy")
def _entry(kind: int, o: NDArray[np.float64], d0: float, d1: float, d2: float) -> float:
    """Return how far along a ray a unit ball, cube or upright cylinder begins; from inside, how far it ends."""
    if kind == _ELLIPSOID:
        a = d0 * d0 + d1 * d1 + d2 * d2
        b = o[0] * d0 + o[1] * d1 + o[2] * d2
        square = b * b - a * (o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - 1.0)
        if square < 0.0:
            return np.inf
        root = math.sqrt(square)
        enter, leave = (-b - root) / a, (-b + root) / a
    else:
        w = 1.0 / d2
        enter, leave = -o[2] * w - abs(w), -o[2] * w + abs(w)
        if kind == _BOX:
            w = 1.0 / d0
            enter, leave = max(enter, -o[0] * w - abs(w)), min(leave, -o[0] * w + abs(w))
            w = 1.0 / d1
            enter, leave = max(enter, -o[1] * w - abs(w)), min(leave, -o[1] * w + abs(w))
        else:
            a = max(d0 * d0 + d1 * d1, 1e-12)
            b = o[0] * d0 + o[1] * d1
            square = b * b - a * (o[0] * o[0] + o[1] * o[1] - 1.0)
            if square < 0.0:
                return np.inf
            root = math.sqrt(square)
            enter, leave = max(enter, (-b - root) / a), min(leave, (-b + root) / a)
        if not enter <= leave:
            return np.inf
    if leave < 0.0:
        return np.inf
    found: float = enter if enter >= 0.0 else leave
    return found
