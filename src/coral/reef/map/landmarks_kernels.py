"""Hot loop of the landmark detector: a camera picture as a horizontal scan of standing obstacles."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

OBSTACLE = 2


@njit(cache=True)
def scan(
    depth: NDArray[np.float32],
    labels: NDArray[np.uint8],
    sector: NDArray[np.int64],
    length: NDArray[np.float64],
    limits: tuple[float, int, float],
    ranges: NDArray[np.float64],
    counts: NDArray[np.int64],
) -> None:
    """Measure the nearest standing obstacle in every sector of bearing: the median range of its pixels.

    Args:
        depth: Shape=(H, W), metres along the optical axis; inf where nothing is seen.
        labels: Shape=(H, W), pixel classes.
        sector: Shape=(H, W), sector of each pixel's bearing in the horizontal plane, -1 for none.
        length: Shape=(H, W), horizontal distance of each pixel at unit depth.
        limits: Longest range (m), fewest pixels of an obstacle in a sector, and how far behind the nearest fifth of a
            sector's pixels the rest may lie (m); what is farther belongs to another obstacle.
        ranges: Shape=(S,), horizontal distance from the camera (m), inf where nothing stands; written.
        counts: Shape=(S,), the obstacle's pixels; written.
    """
    range_m, least, split_m = limits
    height, width = depth.shape
    counts[:] = 0
    for v in range(height):
        for u in range(width):
            if labels[v, u] == OBSTACLE and sector[v, u] >= 0 and depth[v, u] * length[v, u] <= range_m:
                counts[sector[v, u]] += 1
    found = np.empty((len(ranges), max(1, counts.max())))
    counts[:] = 0
    for v in range(height):
        for u in range(width):
            k = sector[v, u]
            if labels[v, u] == OBSTACLE and k >= 0 and depth[v, u] * length[v, u] <= range_m:
                found[k, counts[k]] = depth[v, u] * length[v, u]
                counts[k] += 1
    for k in range(len(ranges)):
        ranges[k], near = np.inf, counts[k]
        if near >= least:
            column = np.sort(found[k, :near])
            while column[near - 1] > column[counts[k] // 5] + split_m:
                near -= 1
            if near >= least:
                ranges[k] = column[near // 2]
        counts[k] = near if ranges[k] < np.inf else 0
