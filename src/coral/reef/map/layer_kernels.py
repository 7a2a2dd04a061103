"""Marking what a range image says about the cells of the map."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

HIT, LOW, LEVEL, THROUGH = 1, 2, 4, 8
"""What an image says of a cell: an echo there; beams passed just above the floor; at the vehicle's height; where an
echo was before."""


@njit(cache=True)
def mark(
    ranges: NDArray[np.float32],
    beams: NDArray[np.float64],
    turn: NDArray[np.float64],
    place: tuple[float, float, float],
    cell_m: float,
    band: tuple[float, float],
    low_m: float,
    level: tuple[float, float],
    reach_m: float,
    hit_m: float,
    back_m: float,
    height: NDArray[np.float32],
    said: NDArray[np.uint8],
) -> None:
    """Trace every beam over the grid and note what it says about each cell.

    Args:
        ranges: Shape=(H, W), range along each beam (m), inf without an echo.
        beams: Shape=(H, W, 3), unit vectors in the sonar's frame.
        turn: Shape=(3, 3), sonar frame to world.
        place: x and y of the sonar in the world (m), and its height above the sea floor (m).
        cell_m: Edge of a cell (m).
        band: Lowest and greatest height above the sea floor (m) at which an echo is an obstacle.
        low_m: A beam below this height (m) proves that nothing stands there.
        level: Heights (m) between which a beam proves that nothing floats in the vehicle's way.
        reach_m: Largest horizontal distance (m) at which a passing beam counts.
        hit_m: The same for an echo.
        back_m: A beam says nothing about the last stretch before its echo (m): the noise of ranges.
        height: Shape=(NY, NX), mean height of the echoes in a cell (m); NaN without any.
        said: Shape=(NY, NX), bits HIT, LOW, LEVEL and THROUGH, set in place.
    """
    ny, nx = said.shape
    rows, columns = ranges.shape
    x0, y0, z0 = place
    for u in range(columns):
        echoes = 0
        for v in range(rows):
            echoes += ranges[v, u] < np.inf
        for v in range(rows):
            a, b, c = beams[v, u, 0], beams[v, u, 1], beams[v, u, 2]
            dx = turn[0, 0] * a + turn[0, 1] * b + turn[0, 2] * c
            dy = turn[1, 0] * a + turn[1, 1] * b + turn[1, 2] * c
            dz = turn[2, 0] * a + turn[2, 1] * b + turn[2, 2] * c
            flat = math.sqrt(dx * dx + dy * dy)
            if flat < 1e-6:
                continue
            r = ranges[v, u]
            if r < np.inf:
                far, z = r * flat, z0 + r * dz
                if far <= hit_m and band[0] < z < band[1]:
                    ix, iy = int(math.floor((x0 + r * dx) / cell_m)), int(math.floor((y0 + r * dy) / cell_m))
                    if ix >= 0 and iy >= 0 and ix < nx and iy < ny:
                        said[iy, ix] |= HIT
                        old = height[iy, ix]
                        height[iy, ix] = z if math.isnan(old) else 0.8 * old + 0.2 * z
                reach = min(far - back_m, reach_m)
            elif 4 * echoes >= rows and dz > -0.05:
                reach = reach_m  # no echo: clear water, if the column hears anything and the floor is not due here
            else:
                continue
            if v & 1:
                continue  # neighbouring rows pass the same cells
            ux, uy, rise = dx / flat, dy / flat, dz / flat
            for k in range(int(reach / cell_m)):
                d = (k + 0.5) * cell_m
                z = z0 + d * rise
                if z < 0.0:
                    break
                ix, iy = int(math.floor((x0 + d * ux) / cell_m)), int(math.floor((y0 + d * uy) / cell_m))
                if ix < 0 or iy < 0 or ix >= nx or iy >= ny:
                    break
                if z <= low_m:
                    said[iy, ix] |= LOW
                if level[0] <= z <= level[1]:
                    said[iy, ix] |= LEVEL
                old = height[iy, ix]
                if r < np.inf and abs(z - old) < 0.1:  # never with NaN
                    said[iy, ix] |= THROUGH


@njit(cache=True)
def count(
    said: NDArray[np.uint8],
    window: tuple[int, int, int, int],
    hits_needed: int,
    ratio: float,
    hits: NDArray[np.uint16],
    through: NDArray[np.uint16],
    clear: NDArray[np.uint8],
    obstacle: NDArray[np.bool_],
    remembered: int,
) -> int:
    """Add what one image says to the counts inside `window` (y0, y1, x0, x1), and clear `said` for the next one.

    An echo outweighs a beam that passes the same cell: a cell is partly filled. At `remembered` images of a kind, both
    counts of a cell are halved.
    """
    changed = 0
    for iy in range(window[0], window[1]):
        for ix in range(window[2], window[3]):
            now = said[iy, ix]
            if now == 0:
                continue
            said[iy, ix] = 0
            clear[iy, ix] |= now & (LOW | LEVEL)
            if now & HIT:
                hits[iy, ix] += 1
            elif now & THROUGH:
                through[iy, ix] += 1
            else:
                continue
            if max(hits[iy, ix], through[iy, ix]) >= remembered:
                hits[iy, ix] >>= 1
                through[iy, ix] >>= 1
            solid = hits[iy, ix] >= hits_needed and hits[iy, ix] >= ratio * through[iy, ix]
            if solid != obstacle[iy, ix]:
                obstacle[iy, ix] = solid
                changed += 1
    return changed
