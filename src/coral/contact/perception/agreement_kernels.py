"""Agreement between a picture and an object drawn at a pose; and a first shift that moves the drawing onto the mask."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.contact.perception.image_patch import ROBOT, ImagePatch
from coral.contact.perception.normal_kernels import draw_with_normals
from coral.contact.perception.raycast_kernels import draw_object
from coral.contact.perception.solids import Solids

AGREE, WRONG, UNCOVERED, FREE, HIDDEN, DRAWN, RESIDUAL = 0, 1, 2, 3, 4, 5, 6
"""Entries of the tally that `count_agreement` returns."""
ROUNDS = 2
"""Drawings with which `shift_onto_mask` is near enough."""


@njit(cache=True, error_model="numpy")
def count_agreement(
    T_camera_object: NDArray[np.float64], solids: Solids, patch: ImagePatch, margin: float
) -> NDArray[np.float64]:
    """Count the pixels that the object at T_camera_object, Shape=(4, 4), explains, and those that it does not.

    Measured and drawn surface agree within `margin` (m) along the normal, and within four times this distance along the
    optical axis: depth is noisier on slanted surfaces. Returns Shape=(7,): pixels where depths agree, where they do
    not, where the drawing does not cover the mask, where it covers free space, where something nearer occludes it,
    where it is drawn; and the sum of |difference| / margin over the pixels that agree. Pixels next to an outline count
    as neither uncovered nor free.
    """
    measured, mask, field, occlusion, lens = patch.depth, patch.mask, patch.mask_distance, patch.occlusion, patch.lens
    height, width = measured.shape
    depth, solid, normal = draw_with_normals(T_camera_object, solids, lens, height, width)
    tally = np.zeros(7)
    for v in range(height):
        q = (v - lens[3]) / lens[1]
        for u in range(width):
            p = (u - lens[2]) / lens[0]
            seen = measured[v, u]
            if solid[v, u] >= 0:
                tally[DRAWN] += 1.0
                difference = seen - depth[v, u]
                if mask[v, u]:
                    if seen == 0.0:
                        continue
                    slope = abs(normal[v, u, 0] * p + normal[v, u, 1] * q + normal[v, u, 2])
                    gap = max(slope, 0.25) * abs(difference)
                    if gap < margin:
                        tally[AGREE] += 1.0
                        tally[RESIDUAL] += gap / margin
                    else:
                        tally[WRONG] += 1.0
                elif occlusion[v, u] == ROBOT or (seen > 0.0 and difference < -margin):
                    tally[HIDDEN] += 1.0
                elif field[v, u] > 1.5:
                    tally[FREE] += 1.0
            elif mask[v, u]:
                near = False
                for a in range(max(0, v - 1), min(height, v + 2)):
                    for c in range(max(0, u - 1), min(width, u + 2)):
                        near = near or solid[a, c] >= 0
                if not near:
                    tally[UNCOVERED] += 1.0
    return tally


@njit(cache=True, error_model="numpy")
def shift_onto_mask(
    T_camera_object: NDArray[np.float64], solids: Solids, patch: ImagePatch, rounds: int
) -> NDArray[np.float64]:
    """Return the pose, Shape=(4, 4), shifted until the object's drawing has the centre and mean depth of the mask."""
    measured, mask, lens = patch.depth, patch.mask, patch.lens
    height, width = measured.shape
    pose = T_camera_object.copy()
    for _ in range(rounds):
        depth, solid, _ = draw_object(pose, solids, lens, height, width)[0]
        mu, mv, mz, m, mn = 0.0, 0.0, 0.0, 0.0, 0.0
        du, dv, dz, d = 0.0, 0.0, 0.0, 0.0
        for v in range(height):
            for u in range(width):
                if mask[v, u]:
                    mu, mv, mn = mu + u, mv + v, mn + 1.0
                    if measured[v, u] > 0.0:
                        mz, m = mz + measured[v, u], m + 1.0
                if solid[v, u] >= 0:
                    du, dv, dz, d = du + u, dv + v, dz + depth[v, u], d + 1.0
        if m == 0.0 or d == 0.0:
            break
        z = mz / m
        ratio = z / (dz / d)
        pose[2, 3] += z - dz / d
        pose[0, 3] = pose[0, 3] * ratio + (mu / mn - du / d) / lens[0] * z
        pose[1, 3] = pose[1, 3] * ratio + (mv / mn - dv / d) / lens[1] * z
    return pose
