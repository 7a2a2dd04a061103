"""Hot loops of the occupancy map: Eq. 1 projection and the explored-area ray casting (paper III-A)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

OYSTER, OBSTACLE, SEABED = 1, 2, 3
SATURATED = 60000


class Counts(NamedTuple):
    """What pictures have shown of each cell. Shape=(NY, NX) each."""

    targets: NDArray[np.uint16]
    """Pictures that show oysters there."""
    obstacles: NDArray[np.uint16]
    """Pictures that show obstacles."""
    ground: NDArray[np.uint16]
    """Pictures that show seabed."""
    counted: NDArray[np.int32]
    """Classes that the last picture counted: 8 picture + a bit per class."""
    sharp: NDArray[np.bool_]
    """Cells that have been seen from near. What was counted from farther away is forgotten then, and nothing more from
    there is counted."""


class Nearness(NamedTuple):
    """From how near each cell has been seen, and where oysters show beyond the map's range."""

    nearest: NDArray[np.float32]
    """Smallest distance along the line of sight (m). Shape=(NY, NX)."""
    neared: NDArray[np.int32]
    """The picture of that distance. Shape=(NY, NX)."""
    hints: NDArray[np.uint16]
    """Pictures with oysters there, beyond the map's range. Shape=(MY, MX)."""
    hinted: NDArray[np.int32]
    """Last picture that counted for each cell of the hints. Shape=(MY, MX)."""
    hint_cell_m: float


@njit(cache=True)
def project(
    depth: NDArray[np.float32],
    labels: NDArray[np.uint8],
    rays: NDArray[np.float64],
    pose: tuple[float, float, float],
    cell_m: float,
    target_range_m: float,
    obstacle_range_m: float,
    sharp_m: float,
    counts: Counts,
    nearness: Nearness,
    picture: int,
    column_reach: NDArray[np.float64],
    remembered: int,
) -> None:
    """Project every pixel into the grid (Eq. 1). Each cell counts the pictures that show a class there.

    It counts pictures, not pixels: segmentation errs in patches, and a wrong patch puts many pixels into one cell.

    Args:
        depth: Shape=(H, W), metres along the optical axis; inf where nothing is seen.
        labels: Shape=(H, W), pixel classes.
        rays: Shape=(H, W, 3), forward and left components (body frame) of each pixel's ray at unit depth, its length.
        pose: (x, y, theta) of the body in the world.
        cell_m: Edge of a grid cell (m).
        target_range_m: Largest horizontal distance (m) at which oyster and seabed pixels count; oysters farther away
            are hints.
        obstacle_range_m: The same for obstacle pixels.
        sharp_m: Horizontal distance (m) of what is near; 0: all looks are alike, negative: nothing is counted.
        counts: Updated in place.
        nearness: Updated in place.
        picture: Number of this picture, 1 or more.
        column_reach: Shape=(W,), farthest horizontal distance (m) with a return in each column, written.
        remembered: Pictures of a class at which all counts of a cell are halved; those of `SATURATED` never are.
    """
    targets, obstacles, ground, counted, sharp = counts
    nearest, neared, hints, hinted, hint_cell_m = nearness
    ny, nx = targets.shape
    my, mx = hints.shape
    height, width = depth.shape
    c, s = math.cos(pose[2]), math.sin(pose[2])
    x0, y0 = pose[0], pose[1]
    for u in range(width):
        reach = 0.0
        for v in range(height):
            z = depth[v, u]
            if not z < np.inf:
                continue
            forward, left = z * rays[v, u, 0], z * rays[v, u, 1]
            square = forward * forward + left * left
            distance = math.sqrt(square)
            reach = max(reach, distance)
            label = labels[v, u]
            if label != OYSTER and label != OBSTACLE and label != SEABED:
                continue
            x, y = x0 + c * forward - s * left, y0 + s * forward + c * left
            far = square > target_range_m * target_range_m
            if far and label == OYSTER:
                ix, iy = int(math.floor(x / hint_cell_m)), int(math.floor(y / hint_cell_m))
                if ix >= 0 and iy >= 0 and ix < mx and iy < my and hinted[iy, ix] != picture:
                    hinted[iy, ix] = picture
                    hints[iy, ix] = min(hints[iy, ix] + 1, SATURATED)
            ix, iy = int(math.floor(x / cell_m)), int(math.floor(y / cell_m))
            if ix < 0 or iy < 0 or ix >= nx or iy >= ny:
                continue
            if label != OBSTACLE and not far and z * rays[v, u, 2] < nearest[iy, ix]:
                nearest[iy, ix] = z * rays[v, u, 2]
                neared[iy, ix] = picture
            if sharp_m < 0.0 or distance > (obstacle_range_m if label == OBSTACLE else target_range_m):
                continue
            done = counted[iy, ix]
            if distance > sharp_m:
                if sharp[iy, ix]:
                    continue
            elif not sharp[iy, ix]:
                sharp[iy, ix] = True
                targets[iy, ix] = ground[iy, ix] = done = 0
            if done >> 3 != picture:
                done = picture << 3
            bit = 1 << (label - 1)
            if done & bit:
                continue
            counted[iy, ix] = done | bit
            if label == OYSTER:
                targets[iy, ix] += 1
            elif label == OBSTACLE:
                obstacles[iy, ix] = min(obstacles[iy, ix] + 1, SATURATED)
            else:
                ground[iy, ix] += 1
            if obstacles[iy, ix] == SATURATED:
                ground[iy, ix], targets[iy, ix] = min(ground[iy, ix], remembered), min(targets[iy, ix], remembered)
            elif max(targets[iy, ix], obstacles[iy, ix], ground[iy, ix]) >= remembered:
                targets[iy, ix] >>= 1
                obstacles[iy, ix] >>= 1
                ground[iy, ix] >>= 1
        column_reach[u] = reach


@njit(cache=True)
def explore(
    explored: NDArray[np.bool_],
    blocked: NDArray[np.bool_],
    origin: tuple[float, float],
    heading: float,
    hfov: float,
    n_rays: int,
    range_m: float,
    cell_m: float,
    tangent_half: float,
    column_reach: NDArray[np.float64],
) -> None:
    """Cast `n_rays` rays over the field of view and mark the cells they pass as explored.

    A ray ends at the first blocked cell, at `range_m`, or at the last return in its image column, whichever comes
    first: no cell counts as explored that the camera could not see.

    Args:
        explored: Shape=(NY, NX), updated in place.
        blocked: Shape=(NY, NX), known obstacles.
        origin: Camera position in the world (m).
        heading: Camera heading in the world (rad).
        hfov: Horizontal field of view (rad).
        n_rays: Number of rays.
        range_m: Longest ray (m).
        cell_m: Edge of a grid cell (m).
        tangent_half: tan(hfov / 2).
        column_reach: Shape=(W,), farthest return per image column (m).
    """
    ny, nx = explored.shape
    width = column_reach.shape[0]
    for k in range(n_rays):
        bearing = (k + 0.5) / n_rays * hfov - 0.5 * hfov
        column = int(0.5 * width * (1.0 - math.tan(bearing) / tangent_half))
        column = min(max(column, 0), width - 1)
        reach = min(range_m, column_reach[column])
        dx, dy = math.cos(heading + bearing) * cell_m, math.sin(heading + bearing) * cell_m
        x, y = origin
        for _ in range(int(reach / cell_m)):
            ix, iy = int(math.floor(x / cell_m)), int(math.floor(y / cell_m))
            if ix < 0 or iy < 0 or ix >= nx or iy >= ny:
                break
            explored[iy, ix] = True
            if blocked[iy, ix]:
                break
            x += dx
            y += dy


@njit(cache=True)
def classify(
    counts: Counts,
    target_hits: int,
    obstacle_hits: int,
    target_ratio: float,
    sharp_ratio: float,
    obstacle_ratio: float,
    target_mask: NDArray[np.bool_],
    obstacle_mask: NDArray[np.bool_],
    window: tuple[int, int, int, int],
) -> int:
    """Turn counts into masks inside `window` (y0, y1, x0, x1). Return the number of obstacle cells that changed."""
    targets, obstacles, ground, _, sharp = counts
    changed = 0
    for iy in range(window[0], window[1]):
        for ix in range(window[2], window[3]):
            hard, soft = obstacles[iy, ix] >= obstacle_hits, targets[iy, ix] >= target_hits
            if not (hard or soft or obstacle_mask[iy, ix] or target_mask[iy, ix]):
                continue  # nearly all cells
            floor = ground[iy, ix]
            solid = hard and obstacles[iy, ix] >= obstacle_ratio * floor
            if solid != obstacle_mask[iy, ix]:
                obstacle_mask[iy, ix] = solid
                changed += 1
            ratio = sharp_ratio if sharp[iy, ix] else target_ratio
            target_mask[iy, ix] = soft and targets[iy, ix] >= ratio * floor and not solid
    return changed
