"""Cells of the true oyster area that come into view: range, field of view, line of sight on the ground plane."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.world.scene import Footprints

_ELLIPSE = 0


@njit(cache=True)
def observe(
    pose: tuple[float, float, float],
    half_fov: float,
    range_m: float,
    cells: NDArray[np.float64],
    start: NDArray[np.int64],
    circle: NDArray[np.float64],
    seen: NDArray[np.bool_],
    left: NDArray[np.int64],
    outlines: Footprints,
    unit: NDArray[np.float64],
) -> None:
    """Mark the cells seen from a pose.

    Args:
        pose: (x, y, theta) in the world.
        half_fov: Half of the horizontal field of view (rad), at most pi.
        range_m: Largest distance at which a cell is seen (m).
        cells: Shape=(M, 2), centres of all cells (m), cluster by cluster.
        start: Shape=(C + 1,), first cell of every cluster, and the number of cells.
        circle: Shape=(C, 3), circle (x, y, radius) that contains the cells of every cluster.
        seen: Shape=(M,), whether a cell has been seen; updated in place.
        left: Shape=(C,), number of each cluster's cells not yet seen; updated in place.
        outlines: K of them, which hide cells.
        unit: Shape=(K, 7), scratch.
    """
    kind, center, half, yaw = outlines
    x, y = pose[0], pose[1]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    edge = math.cos(half_fov)
    # Rows of unit: the map from an outline to the unit circle or square (4), the eye in that frame (2), round (1).
    hiders = 0
    for k in range(kind.size):
        dx, dy = x - center[k, 0], y - center[k, 1]
        reach = range_m + half[k, 0] + half[k, 1]
        if dx * dx + dy * dy > reach * reach:
            continue
        ck, sk = math.cos(yaw[k]), math.sin(yaw[k])
        unit[hiders, 0], unit[hiders, 1] = ck / half[k, 0], sk / half[k, 0]
        unit[hiders, 2], unit[hiders, 3] = -sk / half[k, 1], ck / half[k, 1]
        unit[hiders, 4] = unit[hiders, 0] * dx + unit[hiders, 1] * dy
        unit[hiders, 5] = unit[hiders, 2] * dx + unit[hiders, 3] * dy
        unit[hiders, 6] = 1.0 if kind[k] == _ELLIPSE else 0.0
        hiders += 1
    for cluster in range(left.size):
        if left[cluster] == 0:
            continue
        dx, dy = circle[cluster, 0] - x, circle[cluster, 1] - y
        reach = range_m + circle[cluster, 2]
        if not dx * dx + dy * dy <= reach * reach:  # "not <=" skips NaN too
            continue
        for i in range(start[cluster], start[cluster + 1]):
            if seen[i]:
                continue
            dx, dy = cells[i, 0] - x, cells[i, 1] - y
            distance = math.sqrt(dx * dx + dy * dy)
            in_view = distance <= range_m and c * dx + s * dy >= edge * distance
            if in_view and not _hidden(dx, dy, unit[:hiders]):
                seen[i] = True
                left[cluster] -= 1


@njit(cache=True)
def _hidden(dx: float, dy: float, unit: NDArray[np.float64]) -> bool:
    """Check whether the segment from the eye to eye + (dx, dy) crosses an outline."""
    for k in range(unit.shape[0]):
        gx, gy = unit[k, 0] * dx + unit[k, 1] * dy, unit[k, 2] * dx + unit[k, 3] * dy
        ex, ey = unit[k, 4], unit[k, 5]
        if unit[k, 6] > 0.0:
            square = gx * gx + gy * gy
            near = -(ex * gx + ey * gy)
            near = 0.0 if near <= 0.0 else (1.0 if near >= square else near / square)
            px, py = ex + near * gx, ey + near * gy
            if px * px + py * py < 1.0:
                return True
        else:
            enter, leave = 0.0, 1.0
            for e, g in ((ex, gx), (ey, gy)):
                if g == 0.0:
                    if abs(e) >= 1.0:
                        enter = 2.0
                    continue
                first, second = (-1.0 - e) / g, (1.0 - e) / g
                enter = max(enter, min(first, second))
                leave = min(leave, max(first, second))
            if enter < leave:
                return True
    return False
