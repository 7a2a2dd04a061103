"""Visibility of true oyster points in a picture: angles of view, distance, line of sight."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

_ELLIPSOID, _BOX = 0, 1
UNSEEN, IMAGED, INSPECTED = 0, 1, 2
"""Levels of a point."""


class Sight(NamedTuple):
    """What does not change from picture to picture: the camera, M points, and K solids that hide some."""

    lens: tuple[float, float, float, float]
    """Tangents of the picture's left, right, upper and lower edge: X / Z and Y / Z of the outer pixels' edges."""
    limits: tuple[float, float, float]
    """Smallest depth (m), largest distance of an imaged point (m) and of an inspected point (m)."""
    points: NDArray[np.float64]
    """In the world (m). Shape=(M, 3)."""
    group: NDArray[np.int64]
    """The cluster of each. Shape=(M,)."""
    kind: NDArray[np.int8]
    """As `Scene.kind`. Shape=(K,)."""
    center: NDArray[np.float64]
    """Shape=(K, 3)."""
    unit: NDArray[np.float64]
    """World to the frame in which the solid is the unit ball, cube or cylinder. Shape=(K, 3, 3)."""
    radius: NDArray[np.float64]
    """Of a ball about the centre that holds the solid (m). Shape=(K,)."""


@njit(cache=True, error_model="numpy")
def image(
    eye: NDArray[np.float64],
    turn: NDArray[np.float64],
    sight: Sight,
    level: NDArray[np.uint8],
    count: NDArray[np.int64],
) -> None:
    """Raise the level of every point that a picture shows better than any picture before.

    Args:
        eye: Shape=(3,), position of the camera in the world (m).
        turn: Shape=(3, 3), camera optical frame to world.
        sight: Camera, points and what hides them.
        level: Shape=(M,), best level of each point so far; updated in place.
        count: Shape=(3, C), number of points of each cluster at or above a level; updated in place.
    """
    points, group, kind, center = sight.points, sight.group, sight.kind, sight.center
    unit, radius = sight.unit, sight.radius
    left, right, top, bottom = sight.lens
    near, far, close = sight.limits
    close = min(close, far)
    near_hiders, scratch = np.empty(kind.size, np.int64), np.empty((kind.size, 3))
    hiders = 0
    for k in range(kind.size):
        dx, dy, dz = eye[0] - center[k, 0], eye[1] - center[k, 1], eye[2] - center[k, 2]
        if dx * dx + dy * dy + dz * dz > (far + radius[k]) ** 2:
            continue
        for i in range(3):
            scratch[hiders, i] = unit[k, i, 0] * dx + unit[k, i, 1] * dy + unit[k, i, 2] * dz
        near_hiders[hiders] = k
        hiders += 1
    for m in range(level.size):
        had = level[m]
        if had == INSPECTED:
            continue
        dx, dy, dz = points[m, 0] - eye[0], points[m, 1] - eye[1], points[m, 2] - eye[2]
        square = dx * dx + dy * dy + dz * dz
        reach = far if had == UNSEEN else close
        if not square <= reach * reach:  # "not <=" skips NaN too
            continue
        z = turn[0, 2] * dx + turn[1, 2] * dy + turn[2, 2] * dz
        if not z >= near:
            continue
        x = turn[0, 0] * dx + turn[1, 0] * dy + turn[2, 0] * dz
        y = turn[0, 1] * dx + turn[1, 1] * dy + turn[2, 1] * dz
        if x < left * z or x > right * z or y < top * z or y > bottom * z:
            continue
        hidden = False
        for h in range(hiders):
            k = near_hiders[h]
            g0 = unit[k, 0, 0] * dx + unit[k, 0, 1] * dy + unit[k, 0, 2] * dz
            g1 = unit[k, 1, 0] * dx + unit[k, 1, 1] * dy + unit[k, 1, 2] * dz
            g2 = unit[k, 2, 0] * dx + unit[k, 2, 1] * dy + unit[k, 2, 2] * dz
            if _blocks(kind[k], scratch[h, 0], scratch[h, 1], scratch[h, 2], g0, g1, g2):
                hidden = True
                break
        if hidden:
            continue
        reached = INSPECTED if square <= close * close else IMAGED
        for step in range(had + 1, reached + 1):
            count[step, group[m]] += 1
        level[m] = reached


@njit(cache=True, error_model="numpy")
def image_along(
    poses: NDArray[np.float64],
    every: int,
    target: float,
    first: NDArray[np.float64],
    sight: Sight,
    level: NDArray[np.uint8],
    count: NDArray[np.int64],
    size: NDArray[np.int64],
) -> int:
    """Process every `every`-th picture of a drive, and the last one, until the mean share inspected reaches `target`.

    Returns the index of the pose at which the target was met, -1 if it never was. `poses` are x, y, theta of the body,
    Shape=(K, 3). `first` is the transform from camera to world for the body at the origin with heading 0, Shape=(4, 4).
    `size` is the number of points of each cluster, Shape=(C,). The other arguments are those of `image`.
    """
    eye, turn = np.empty(3), np.empty((3, 3))
    last = poses.shape[0] - 1
    k = 0
    while k <= last:
        c, s = math.cos(poses[k, 2]), math.sin(poses[k, 2])
        for j in range(3):
            turn[0, j] = c * first[0, j] - s * first[1, j]
            turn[1, j] = s * first[0, j] + c * first[1, j]
            turn[2, j] = first[2, j]
        eye[0] = poses[k, 0] + c * first[0, 3] - s * first[1, 3]
        eye[1] = poses[k, 1] + s * first[0, 3] + c * first[1, 3]
        eye[2] = first[2, 3]
        image(eye, turn, sight, level, count)
        share = 0.0
        for cluster in range(size.size):
            share += count[INSPECTED, cluster] / size[cluster]
        if share / size.size >= target:
            return k
        k = k + every if k == last else min(k + every, last)
    return -1


@njit(cache=True, error_model="numpy")
def _blocks(kind: int, e0: float, e1: float, e2: float, g0: float, g1: float, g2: float) -> bool:
    """Check whether the segment e + t g, 0 <= t <= 1, crosses the unit ball, cube or upright cylinder."""
    if kind == _ELLIPSOID:
        square = g0 * g0 + g1 * g1 + g2 * g2
        t = -(e0 * g0 + e1 * g1 + e2 * g2)
        t = 0.0 if t <= 0.0 else (1.0 if t >= square else t / square)
        a, b, c = e0 + t * g0, e1 + t * g1, e2 + t * g2
        return a * a + b * b + c * c < 1.0
    enter, leave = 0.0, 1.0
    if kind == _BOX:
        enter, leave = _slab(e0, g0, enter, leave)
        enter, leave = _slab(e1, g1, enter, leave)
    else:
        a, b, c = g0 * g0 + g1 * g1, e0 * g0 + e1 * g1, e0 * e0 + e1 * e1 - 1.0
        square = b * b - a * c
        if a < 1e-18:
            if c >= 0.0:
                return False
        elif square <= 0.0:
            return False
        else:
            root = math.sqrt(square)
            enter, leave = max(enter, (-b - root) / a), min(leave, (-b + root) / a)
    enter, leave = _slab(e2, g2, enter, leave)
    return enter < leave


@njit(cache=True, error_model="numpy")
def _slab(e: float, g: float, enter: float, leave: float) -> tuple[float, float]:
    """Return the part of a segment that lies between -1 and 1 along one axis."""
    if g == 0.0:
        return (enter, leave) if abs(e) < 1.0 else (2.0, -1.0)
    first, second = (-1.0 - e) / g, (1.0 - e) / g
    return max(enter, min(first, second)), min(leave, max(first, second))
