"""Geodesic cost-to-go on a grid: fast marching with a bucket queue, and its bilinear lookup (numba)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Grid = NDArray[np.float32]


@njit(cache=True, nogil=True, error_model="numpy")
def slowness(
    distance: Grid, fine_m: float, ratio: int, radius_m: float, band_m: float, penalty: float, out: Grid
) -> None:
    """Compute the cost per metre of coarse cells; negative where the hull does not fit.

    It is 1 in open water and rises quadratically over the last `band_m` to 1 + penalty where the hull would touch an
    obstacle. The edge of the map counts as an obstacle.

    Args:
        distance: Shape=(H, W), distance (m) of fine cells to the nearest obstacle cell.
        fine_m: Edge of a fine cell (m).
        ratio: Fine cells per coarse cell and axis.
        radius_m: Clearance that the robot's centre needs (m).
        band_m: Width of the soft band (m).
        penalty: Extra cost per metre at contact.
        out: Shape=(h, w), written.
    """
    fine_h, fine_w = distance.shape
    cell = fine_m * ratio
    for j in range(out.shape[0]):
        for i in range(out.shape[1]):
            j1, i1 = min((j + 1) * ratio, fine_h), min((i + 1) * ratio, fine_w)
            row, col = j * ratio, i * ratio
            if ratio == 2 and j1 == row + 2 and i1 == col + 2:  # the default case, unrolled
                total = distance[row, col] + distance[row, col + 1]
                mean = 0.25 * (total + distance[row + 1, col] + distance[row + 1, col + 1])
            else:
                mean = distance[row:j1, col:i1].mean()
            x, y = (i + 0.5) * cell, (j + 0.5) * cell
            edge = min(min(x, fine_w * fine_m - x), min(y, fine_h * fine_m - y))
            d = min(mean, edge)
            if d < radius_m:
                out[j, i] = -1.0
            elif d < radius_m + band_m:
                near = 1.0 - (d - radius_m) / band_m
                out[j, i] = 1.0 + penalty * near * near
            else:
                out[j, i] = 1.0


@njit(cache=True, nogil=True, error_model="numpy")
def march(slowness: Grid, cell_m: float, goal_j: int, goal_i: int, gx: float, gy: float, top: float) -> Grid:
    """Solve |grad V| = slowness from the goal outwards; inf where no path leads to the goal. Shape=(h, w), m.

    Fast marching with buckets one third of a cell wide instead of a heap. Cells of a bucket are taken in the order of
    their arrival: the error is far below that of the scheme, and the time is linear in the number of cells. The cells
    around the goal (gx, gy) (m) start with their true distance. Negative slowness: blocked. `top` is the largest.
    """
    # A rim of blocked cells makes bounds checks unnecessary. Cells have a linear index.
    h, w = slowness.shape[0] + 2, slowness.shape[1] + 2
    padded = np.full((h, w), -1.0, np.float32)
    padded[1:-1, 1:-1] = slowness
    cost = padded.ravel()
    value = np.full(h * w, np.inf, np.float32)
    closed = cost < 0.0
    steps = (w, -w, 1, -1)
    width = cell_m / 3.0
    per_bucket = 1.0 / width
    buckets = 16
    while buckets < 2.0 * top * cell_m * per_bucket + 4.0:
        buckets *= 2
    head = np.full(buckets, -1, np.int32)
    tail = np.full(buckets, -1, np.int32)
    capacity = 4 * h * w + 32
    cell_of = np.empty(capacity, np.int32)
    link = np.empty(capacity, np.int32)
    used = 0
    for dj in range(-1, 2):
        for di in range(-1, 2):
            j, i = goal_j + dj, goal_i + di
            cell = (j + 1) * w + i + 1
            if not closed[cell]:
                value[cell] = cost[cell] * math.hypot((i + 0.5) * cell_m - gx, (j + 0.5) * cell_m - gy)
                b = int(value[cell] * per_bucket) & (buckets - 1)
                cell_of[used], link[used] = cell, -1
                if head[b] < 0:
                    head[b] = used
                else:
                    link[tail[b]] = used
                tail[b] = used
                used += 1
    level, empty = 0, 0
    while empty <= buckets:
        b = level & (buckets - 1)
        entry = head[b]
        if entry < 0:
            level += 1
            empty += 1
            continue
        empty = 0
        head[b] = link[entry]
        cell = cell_of[entry]
        if closed[cell]:
            continue
        closed[cell] = True
        for step in steps:
            n = cell + step
            if closed[n]:
                continue
            a = min(value[n - 1], value[n + 1])
            c = min(value[n - w], value[n + w])
            f = cost[n] * np.float32(cell_m)
            low, high = min(a, c), max(a, c)
            gap = high - low
            new = low + f if gap >= f else np.float32(0.5) * (low + high + math.sqrt(f * f + f * f - gap * gap))
            if new < value[n] - np.float32(1e-6) and used < capacity:
                value[n] = new
                b = max(int(new * per_bucket), level) & (buckets - 1)
                cell_of[used], link[used] = n, -1
                if head[b] < 0:
                    head[b] = used
                else:
                    link[tail[b]] = used
                tail[b] = used
                used += 1
    return value.reshape((h, w))[1:-1, 1:-1].copy()


@njit(cache=True, nogil=True, error_model="numpy")
def extend(value: Grid, cell_m: float, steepness: float) -> None:
    """Extrapolate the values of reached cells to all other cells, in place, by two rounds of two raster sweeps.

    A robot inside the blocked band then still finds a descent direction: out of it.
    """
    h, w = value.shape
    f = np.float32(steepness * cell_m)
    blocked = np.empty(h * w, np.int32)
    n = 0
    for cell in range(h * w):
        if value[cell // w, cell % w] == np.inf:
            blocked[n] = cell
            n += 1
    for _ in range(2):
        for k in range(n):
            j, i = blocked[k] // w, blocked[k] % w
            if i > 0:
                value[j, i] = min(value[j, i], value[j, i - 1] + f)
            if j > 0:
                value[j, i] = min(value[j, i], value[j - 1, i] + f)
        for k in range(n - 1, -1, -1):
            j, i = blocked[k] // w, blocked[k] % w
            if i + 1 < w:
                value[j, i] = min(value[j, i], value[j, i + 1] + f)
            if j + 1 < h:
                value[j, i] = min(value[j, i], value[j + 1, i] + f)


@njit(cache=True, nogil=True, error_model="numpy")
def lookup(value: Grid, cell_m: float, x: float, y: float) -> tuple[float, float, float]:
    """Interpolate the value and its gradient (dV/dx, dV/dy) at a world point. Points outside take the edge's value."""
    h, w = value.shape
    fx = min(max(x / cell_m - 0.5, 0.0), w - 1.001)
    fy = min(max(y / cell_m - 0.5, 0.0), h - 1.001)
    i, j = int(fx), int(fy)
    a, b = fx - i, fy - j
    v00, v01, v10, v11 = value[j, i], value[j, i + 1], value[j + 1, i], value[j + 1, i + 1]
    low, high = v00 + a * (v01 - v00), v10 + a * (v11 - v10)
    gx = ((1.0 - b) * (v01 - v00) + b * (v11 - v10)) / cell_m
    return low + b * (high - low), gx, (high - low) / cell_m


@njit(cache=True, nogil=True)
def lookup_many(value: Grid, cell_m: float, xs: NDArray[np.float64], ys: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values of `lookup` at many world points. Shape=(N,)."""
    out = np.empty(xs.size)
    for k in range(xs.size):
        out[k] = lookup(value, cell_m, xs[k], ys[k])[0]
    return out


@njit(cache=True, nogil=True)
def descend(value: Grid, cell_m: float, x: float, y: float, gx: float, gy: float, step_m: float, n_max: int) -> Grid:
    """Return the path of steepest descent from a point, up to the goal (gx, gy) if it gets there. Shape=(n, 2)."""
    path = np.empty((n_max + 1, 2), np.float32)
    path[0, 0], path[0, 1] = x, y
    n = 1
    best, since = np.inf, 0
    while n < n_max:
        v, dx, dy = lookup(value, cell_m, x, y)
        size = math.hypot(dx, dy)
        if math.hypot(gx - x, gy - y) < 2.0 * cell_m:
            path[n, 0], path[n, 1] = gx, gy
            return path[: n + 1]
        if v < best - 1e-4:
            best, since = v, 0
        else:
            since += 1
        if size < 1e-9 or since > 20:
            break
        x -= step_m * dx / size
        y -= step_m * dy / size
        path[n, 0], path[n, 1] = x, y
        n += 1
    return path[:n]
