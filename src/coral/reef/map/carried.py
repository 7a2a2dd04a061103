"""The water around a robot whose estimated place jumps: what it saw last moves along."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Pose, to_robot, to_world, wrap

AROUND_M = 3.0
"""How far about the robot the map moves along: what it may touch before it has seen it anew."""
JUMP_M = 0.15
"""Corrections move the map once they have moved something within `AROUND_M` by this: three cells of 0.05 m. Moved more
often, obstacles would fray."""


Box = tuple[int, int, int, int]
"""Rows and columns of a rectangle of cells: (y0, y1, x0, x1), the ends excluded."""


def around(x: float, y: float, radius_m: float, cell_m: float, shape: tuple[int, int]) -> Box:
    """Return the rectangle of cells within a radius (m) of a point, clipped to a grid of `shape`; empty beyond it."""
    r, iy, ix = math.ceil(radius_m / cell_m) + 1, int(y // cell_m), int(x // cell_m)
    y0, x0 = min(max(iy - r, 0), shape[0]), min(max(ix - r, 0), shape[1])
    return y0, max(min(iy + r + 1, shape[0]), y0), x0, max(min(ix + r + 1, shape[1]), x0)


def is_jump(before: Pose, after: Pose) -> bool:
    """Check whether corrections have moved what is around the robot too far."""
    turn = AROUND_M * abs(wrap(after.theta - before.theta))
    return math.dist(before[:2], after[:2]) + turn >= JUMP_M


def moved(pose: Pose, begin: Pose, end: Pose) -> Pose:
    """Return the pose that the motion from `begin` to `end`, in the robot's frame, leads to from `pose`."""
    x, y = to_world(pose, *to_robot(begin, end.x, end.y))
    return Pose(x, y, wrap(pose.theta + end.theta - begin.theta))


def moved_cells(
    shape: tuple[int, int], cell_m: float, before: Pose, after: Pose
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the cells around the robot after a jump, and those that lay in the same place of its frame before.

    Args:
        shape: Rows and columns of the grid.
        cell_m: Edge of a cell (m).
        before: The robot's pose as it was believed.
        after: The corrected one, of the same moment.

    Returns:
        Two arrays of flat indices, only of cells that lie in the grid both times. Shape=(N,) each.
    """
    reach = math.ceil(AROUND_M / cell_m)
    rows, columns = np.mgrid[-reach : reach + 1, -reach : reach + 1].reshape(2, -1)
    rows, columns = rows + int(after.y // cell_m), columns + int(after.x // cell_m)
    x, y = (columns + 0.5) * cell_m - after.x, (rows + 0.5) * cell_m - after.y
    c, s = math.cos(before.theta - after.theta), math.sin(before.theta - after.theta)
    from_columns = np.floor((before.x + c * x - s * y) / cell_m).astype(np.intp)
    from_rows = np.floor((before.y + s * x + c * y) / cell_m).astype(np.intp)
    ny, nx = shape
    kept = np.hypot(x, y) <= AROUND_M
    for row, column in ((rows, columns), (from_rows, from_columns)):
        kept &= (row >= 0) & (row < ny) & (column >= 0) & (column < nx)
    return (rows * nx + columns)[kept], (from_rows * nx + from_columns)[kept]
