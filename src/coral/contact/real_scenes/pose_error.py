"""The field's measures of a pose error: ADD, ADD-S and MSSD."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.contact.perception.symmetry import Symmetry

Array = NDArray[np.float64]


def add(estimate: Array, truth: Array, points: Array) -> float:
    """Compute the mean distance (m) between corresponding points (Hinterstoisser et al., ACCV 2012).

    Args:
        estimate: Shape=(4, 4), object to any frame.
        truth: Shape=(4, 4), object to the same frame.
        points: Shape=(n, 3) m, points of the object.
    """
    return float(np.linalg.norm(_transform_points(estimate, points) - _transform_points(truth, points), axis=1).mean())


def add_s(estimate: Array, truth: Array, points: Array) -> float:
    """Compute the mean distance (m) from true points to the nearest estimated point; arguments as of `add`.

    Between equal poses of a symmetric object it is about half the spacing of the points, not 0, unless the points are
    symmetric too.
    """
    return float(_nearest(_transform_points(truth, points), _transform_points(estimate, points)).mean())


def mssd(estimate: Array, truth: Array, points: Array, symmetry: Symmetry) -> float:
    """Compute the largest distance (m) between corresponding points for the best equal pose (BOP, Hodan et al.)."""
    wanted = _transform_points(truth, points)
    return min(
        float(np.linalg.norm(_transform_points(estimate @ s, points) - wanted, axis=1).max())
        for s in [np.eye(4), np.linalg.inv(estimate) @ symmetry.nearest(estimate, truth), *symmetry.members()]
    )


def _transform_points(pose: Array, points: Array) -> Array:
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])


@njit(cache=True, error_model="numpy")
def _nearest(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the distance of every point to the nearest of the others."""
    found = np.empty(len(points))
    for i in range(len(points)):
        best = np.inf
        for j in range(len(others)):
            x, y, z = points[i, 0] - others[j, 0], points[i, 1] - others[j, 1], points[i, 2] - others[j, 2]
            best = min(best, x * x + y * y + z * z)
        found[i] = np.sqrt(best)
    return found
