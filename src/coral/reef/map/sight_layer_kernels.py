"""One line of sight per bearing out of a picture, and the evidence of these lines on the grid."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

OYSTER, OBSTACLE, SEABED = 1, 2, 3


@njit(cache=True)
def scan(
    depth: NDArray[np.float32],
    labels: NDArray[np.uint8],
    flat: NDArray[np.float64],
    plane: NDArray[np.float64],
    bearing: NDArray[np.int64],
    share: float,
    gap: int,
    ranges: NDArray[np.float64],
    first: NDArray[np.float64],
    last: NDArray[np.float64],
) -> None:
    """Find the nearest obstacle and the sea floor in front of it along every bearing.

    An obstacle that stands on the floor is where its foot is, whatever depth it was given; one that overhangs its foot,
    or floats, is nearer, and there only the depth tells. So its range is the lesser of both.

    Args:
        depth: Shape=(H, W), metres along the optical axis; inf where nothing is seen.
        labels: Shape=(H, W), pixel classes.
        flat: Shape=(H, W), horizontal length of each pixel's ray at unit depth.
        plane: Shape=(H, W), horizontal distance (m) at which each pixel's ray meets the floor; inf above the horizon.
        bearing: Shape=(H, W), index of each pixel's bearing.
        share: Share of the obstacle's pixels along a bearing that may be nearer than its range: errors of depth.
        gap: Rows of pixels that may be missing of the floor.
        ranges: Shape=(K,), written: horizontal distance (m) of the nearest obstacle, inf without any.
        first: Shape=(K,), written: of the nearest floor that is seen; inf without any.
        last: Shape=(K,), written: of the farthest floor that is seen without a gap, before the obstacle.
    """
    rows, columns = depth.shape
    n = len(ranges)
    count = np.zeros(n + 1, np.int64)
    kind = np.zeros((rows, columns), np.uint8)
    ranges[:] = np.inf
    first[:] = np.inf
    last[:] = 0.0
    for u in range(columns):
        missing, linked = -1, True  # -1: no floor so far
        for v in range(rows - 1, -1, -1):
            k, label = bearing[v, u], labels[v, u]
            if label == OBSTACLE:
                linked = False
                above = v > 0 and labels[v - 1, u] == OBSTACLE
                if above or (v + 1 < rows and labels[v + 1, u] == OBSTACLE):  # one pixel alone is no obstacle
                    kind[v, u] = OBSTACLE
                    count[k + 1] += 1
                    ranges[k] = min(ranges[k], plane[v, u])
            elif label in (SEABED, OYSTER) and missing <= gap:
                missing = 0
                if linked:
                    kind[v, u] = SEABED
            elif missing >= 0:
                missing += 1
    for k in range(n):
        count[k + 1] += count[k]
    near, at = np.empty(count[n], np.float64), count.copy()
    for v in range(rows):
        for u in range(columns):
            k = bearing[v, u]
            if kind[v, u] == OBSTACLE:
                near[at[k]] = depth[v, u] * flat[v, u]
                at[k] += 1
            elif kind[v, u] == SEABED and plane[v, u] < np.inf:
                first[k] = min(first[k], plane[v, u])
                last[k] = max(last[k], plane[v, u])
    for k in range(n):
        if count[k + 1] > count[k]:
            sorted_m = np.sort(near[count[k] : count[k + 1]])
            ranges[k] = min(ranges[k], sorted_m[int(share * len(sorted_m))])
    own = ranges.copy()
    for k in range(n):
        if count[k + 1] > count[k]:  # rows of pixels near the feet skip some bearings
            ranges[k] = min(own[k - 1], own[k], own[(k + 1) % n])
        last[k] = min(last[k], ranges[k])


@njit(cache=True)
def trace(
    ranges: NDArray[np.float64],
    first: NDArray[np.float64],
    last: NDArray[np.float64],
    origin: tuple[float, float],
    heading: float,
    cell_m: float,
    reach_m: float,
    explore_m: float,
    sharp_m: float,
    back_m: float,
    back_share: float,
    through: float,
    most: float,
    solid: float,
    counts: bool,
    beyond_doubt: tuple[float, float],
    odds: NDArray[np.float32],
    aspect: NDArray[np.float32],
    sure: NDArray[np.bool_],
    said: NDArray[np.int32],
    picture: int,
    explored: NDArray[np.bool_],
    obstacle: NDArray[np.bool_],
) -> int:
    """Add what a picture's lines of sight say to the evidence of the cells. Each cell is told once.

    Args:
        ranges: Of `scan`. Shape=(K,), evenly spaced over a full turn from straight behind, to the left.
        first: The same.
        last: The same.
        origin: Place of the camera in the world (m).
        heading: Of the body in the world (rad).
        cell_m: Edge of a cell (m).
        reach_m: Greatest distance (m) at which obstacles and free water count.
        explore_m: Greatest distance (m) at which floor counts as explored.
        sharp_m: Up to this distance (m) a look counts fully, beyond it less, as 1 / distance.
        back_m: Water so near in front of an obstacle (m) is not marked free...
        back_share: ... and this share of its distance in addition: the error of its range.
        through: Weight of a look through a cell; that of an obstacle is 1.
        most: Bounds of the evidence: -most to 2 most.
        solid: Evidence from which a cell is an obstacle.
        counts: Whether the picture counts as evidence; if not, it only explores.
        beyond_doubt: Distance (m) up to which one line that ends in a cell makes it sure; the angle (rad)
            between two that do.
        odds: Shape=(NY, NX), evidence, updated in place.
        aspect: Shape=(NY, NX), direction (rad) of the first line that ended there, NaN without any, updated in place.
        sure: Shape=(NY, NX), whether an obstacle there is beyond doubt, updated in place.
        said: Shape=(NY, NX), last picture that told each cell, updated in place.
        picture: Number of this picture, 1 or more.
        explored: Shape=(NY, NX), updated in place.
        obstacle: Shape=(NY, NX), updated in place.
    """
    ny, nx = odds.shape
    step, changed = 2.0 * math.pi / len(ranges), 0
    fine = 0.5 * cell_m
    for kind in range(2):  # obstacles first: a cell that one line hits and the next passes is an obstacle
        for k in range(len(ranges)):
            r = ranges[k]
            if kind == 0 and not (counts and r <= reach_m):
                continue
            if kind == 1 and not first[k] < np.inf:
                continue
            far = r + 2.0 * cell_m if kind == 0 else min(last[k] + 0.5 * cell_m, explore_m)
            lines = int(math.ceil(step * far / cell_m))
            free = min(last[k], reach_m)
            if r < np.inf:
                free = min(free, r - back_m - back_share * r)
            for j in range(lines):
                angle = heading - math.pi + (k + (j + 0.5) / lines) * step
                dx, dy = math.cos(angle), math.sin(angle)
                begin = int(max(r - cell_m, 0.0) / fine) if kind == 0 else 0
                for n in range(begin, int(far / fine) + 1):
                    d = (n + 0.5) * fine
                    ix, iy = (
                        int(math.floor((origin[0] + d * dx) / cell_m)),
                        int(math.floor((origin[1] + d * dy) / cell_m)),
                    )
                    if ix < 0 or iy < 0 or ix >= nx or iy >= ny:
                        break
                    if kind == 1:
                        explored[iy, ix] = True
                    if not counts or said[iy, ix] == picture or (kind == 1 and not (first[k] <= d <= free)):
                        continue
                    said[iy, ix] = picture
                    weight = min(1.0, sharp_m / d)
                    told = odds[iy, ix] + (weight if kind == 0 else -through * weight)
                    odds[iy, ix] = min(max(told, -most), 2.0 * most)
                    if kind == 0:
                        if math.isnan(aspect[iy, ix]):
                            aspect[iy, ix] = angle
                        turned = abs((angle - aspect[iy, ix] + math.pi) % (2.0 * math.pi) - math.pi)
                        sure[iy, ix] |= d <= beyond_doubt[0] or turned >= beyond_doubt[1]
                    elif odds[iy, ix] <= 0.0:
                        aspect[iy, ix], sure[iy, ix] = np.nan, False
                    now = odds[iy, ix] >= solid
                    if now != obstacle[iy, ix]:
                        obstacle[iy, ix] = now
                        changed += 1
    return changed
