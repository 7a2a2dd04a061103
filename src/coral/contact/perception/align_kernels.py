"""Alignment of a rendered object with a camera's measurement.

The object is drawn at the present guess by the camera's ray caster, so that only its visible surfaces count.
Gauss-Newton steps minimise the sum of squares of two residuals:

* depth: measured minus drawn point along the drawn normal (point-to-plane, projective association; Chen & Medioni
  1992, Newcombe et al. 2011), where both the object's mask and its drawing are;
* outline: signed distance (pixels, times depth over focal length) from a drawn outline to the mask, which pulls the
  outline in from free space and out to uncovered mask; an outline behind the robot or anything nearer does not count.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.contact.perception.image_patch import NEARER, OCCLUDED_RIM, ROBOT, ImagePatch
from coral.contact.perception.normal_kernels import draw_with_normals
from coral.contact.perception.solids import Solids

_LEVER = 0.03
"""A rotation by 1 rad weighs as much as a shift by this (m): the lever arm of a small object's points."""


@njit(cache=True, error_model="numpy")
def align(
    T_camera_object: NDArray[np.float64],
    pivot: NDArray[np.float64],
    solids: Solids,
    patch: ImagePatch,
    iterations: int,
    wide: float,
    tight: float,
    outline: float,
    hold: float,
) -> NDArray[np.float64]:
    """Improve a pose, Shape=(4, 4), by `iterations` Gauss-Newton steps at most that rotate the object about `pivot`.

    Depth residuals larger than `wide` (m) are ignored in the first step, those larger than `tight` (m) in the last one.
    `outline` is the weight of an outline residual relative to a depth residual; `hold`, in depth residuals, that of the
    first guess along every direction. The pivot is a point of the object (m).
    """
    height, width = patch.depth.shape
    middle, pose = np.empty(3), T_camera_object.copy()
    h, b, gone = np.empty((6, 6)), np.empty(6), np.zeros(6)
    scale = wide
    for _ in range(iterations):
        for i in range(3):
            middle[i] = pose[i, 3]
            for j in range(3):
                middle[i] += pose[i, j] * pivot[j]
        depth, solid, normal = draw_with_normals(pose, solids, patch.lens, height, width)
        _accumulate(middle, depth, normal, solid, patch, scale, outline, h, b)
        for i in range(6):
            weight = hold if i > 2 else hold * _LEVER * _LEVER
            h[i, i] += weight
            b[i] -= weight * gone[i]
        if not _solve(h, b):
            break
        spin = math.sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2])
        move = math.sqrt(b[3] * b[3] + b[4] * b[4] + b[5] * b[5])
        shrink = min(1.0, 0.35 / max(spin, 1e-12), 0.1 / max(move, 1e-12))
        for i in range(6):
            b[i] *= shrink
            gone[i] += b[i]
        _apply(pose, middle, b)
        scale = max(tight, 0.6 * scale)
        if spin < 5e-4 and move < 5e-5 and scale == tight:
            break
    return pose


@njit(cache=True, error_model="numpy")
def _accumulate(
    middle: NDArray[np.float64],
    depth: NDArray[np.float64],
    normal: NDArray[np.float64],
    solid: NDArray[np.int64],
    patch: ImagePatch,
    scale: float,
    outline: float,
    h: NDArray[np.float64],
    b: NDArray[np.float64],
) -> None:
    """Build the normal equations of both residuals for a small rotation about `middle` and a small shift."""
    measured, mask, field, occlusion, lens = patch.depth, patch.mask, patch.mask_distance, patch.occlusion, patch.lens
    height, width = depth.shape
    h[:] = 0.0
    b[:] = 0.0
    row = np.empty(6)
    for v in range(height):
        q = (v - lens[3]) / lens[1]
        for u in range(width):
            if solid[v, u] < 0:
                continue
            p = (u - lens[2]) / lens[0]
            z = depth[v, u]
            seen = measured[v, u]
            if mask[v, u] and seen > 0.0:
                nx, ny, nz = normal[v, u, 0], normal[v, u, 1], normal[v, u, 2]
                residual = (nx * p + ny * q + nz) * (seen - z)
                ratio = residual / scale
                if abs(ratio) < 1.0 and abs(seen - z) < 4.0 * scale:
                    weight = (1.0 - ratio * ratio) ** 2  # Tukey
                    _add(middle, (z * p, z * q, z), (nx, ny, nz), residual, weight, row, h, b)
            if not (0 < u < width - 1 and 0 < v < height - 1):
                continue
            if solid[v, u - 1] >= 0 and solid[v, u + 1] >= 0 and solid[v - 1, u] >= 0 and solid[v + 1, u] >= 0:
                continue
            away = field[v, u]
            if away > 0.0 and (occlusion[v, u] == ROBOT or 0.0 < seen < z - NEARER):
                continue  # occluded
            if away <= 0.0 and occlusion[v, u] == OCCLUDED_RIM:
                continue  # only the occluder ends the mask here
            gu, gv = 0.5 * (field[v, u + 1] - field[v, u - 1]), 0.5 * (field[v + 1, u] - field[v - 1, u])
            weight = outline / max(1.0, abs(away) / 4.0)
            # The residual is the distance by which the outline's point must move along the gradient, in metres at its
            # depth.
            along = gu, gv, -gu * p - gv * q
            _add(middle, (z * p, z * q, z), along, -away * z / lens[0], weight, row, h, b)


@njit(cache=True, error_model="numpy", inline="always")
def _add(
    middle: NDArray[np.float64],
    point: tuple[float, float, float],
    n: tuple[float, float, float],
    residual: float,
    weight: float,
    row: NDArray[np.float64],
    h: NDArray[np.float64],
    b: NDArray[np.float64],
) -> None:
    """Add one equation n . (turn x (point - middle) + shift) = residual."""
    x, y, z = point[0] - middle[0], point[1] - middle[1], point[2] - middle[2]
    row[0], row[1], row[2] = y * n[2] - z * n[1], z * n[0] - x * n[2], x * n[1] - y * n[0]
    row[3], row[4], row[5] = n
    for i in range(6):
        b[i] += weight * row[i] * residual
        for j in range(i + 1):
            h[i, j] += weight * row[i] * row[j]


@njit(cache=True, error_model="numpy")
def _solve(h: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    """Solve h x = b into `b` by Cholesky; return False if nothing was measured.

    The damping leaves unobserved directions, such as the spin of a can, unchanged.
    """
    total = h[3, 3] + h[4, 4] + h[5, 5]
    if total < 1.0:
        return False
    for i in range(3):
        h[i, i] += 1e-3 * total * _LEVER * _LEVER
        h[i + 3, i + 3] += 1e-3 * total
    for i in range(6):
        for j in range(i + 1):
            value = h[i, j]
            for k in range(j):
                value -= h[i, k] * h[j, k]
            if i == j:
                if value <= 0.0:
                    return False
                h[i, i] = math.sqrt(value)
            else:
                h[i, j] = value / h[j, j]
    for i in range(6):
        for k in range(i):
            b[i] -= h[i, k] * b[k]
        b[i] /= h[i, i]
    for i in range(5, -1, -1):
        for k in range(i + 1, 6):
            b[i] -= h[k, i] * b[k]
        b[i] /= h[i, i]
    return True


@njit(cache=True, error_model="numpy")
def _apply(pose: NDArray[np.float64], middle: NDArray[np.float64], step: NDArray[np.float64]) -> None:
    angle = math.sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2])
    s = math.sin(angle) / angle if angle > 1e-12 else 1.0
    c = (1.0 - math.cos(angle)) / (angle * angle) if angle > 1e-12 else 0.5
    m = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            m[i, j] = c * step[i] * step[j]
        m[i, i] += math.cos(angle)
    m[0, 1] -= s * step[2]
    m[0, 2] += s * step[1]
    m[1, 0] += s * step[2]
    m[1, 2] -= s * step[0]
    m[2, 0] -= s * step[1]
    m[2, 1] += s * step[0]
    old = pose.copy()
    for i in range(3):
        pose[i, 3] = middle[i] + step[3 + i]
        for j in range(3):
            pose[i, 3] += m[i, j] * (old[j, 3] - middle[j])
            pose[i, j] = m[i, 0] * old[0, j] + m[i, 1] * old[1, j] + m[i, 2] * old[2, j]
