"""Registration: estimation of an object's pose without a previous one.

It minimises `misfit` over T_camera_object: the share of the picture that the drawn object does not explain. Many
orientations are aligned on a coarse patch of the picture, and the best of them on a fine one.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import agreement_kernels as kernels
from coral.contact.perception.align_kernels import align
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.confidence import MARGIN_M
from coral.contact.perception.image_patch import ImagePatch, box_of, crop_patch, robot_mask
from coral.contact.perception.object_model import ObjectModel
from coral.contact.scene.geometry import rotation_about, spread_rotations
from coral.contact.scene.observation import Array

# Chosen by measurement on the six tasks' objects (docs/research/tracking.md); the paper uses a network.
ORIENTATIONS = 240
"""Orientations spread over all rotations, each class of equal ones tried once. FoundationPose starts from 252."""
HEADINGS = 12
"""Headings tried for each side on which the object may rest: objects on tables do, and they cost little."""
COARSE_PIXELS = 1600
COARSE_STEPS = 8
"""Pixels of the patch and Gauss-Newton steps for every orientation."""
KEPT = 16
"""Number of orientations passed on to the fine alignment."""
FINE_PIXELS = 12000
FINE_STEPS = 20
"""Pixels of the patch and Gauss-Newton steps of the fine alignment."""
OUTLINE = 2.0
"""Weight of an outline pixel relative to a depth pixel."""
WIDE_M = 0.04
TIGHT_M = 0.01
"""Depth residuals larger than this are ignored, in the first step and in the last one."""


def start_orientations(model: ObjectModel) -> Array:
    """Choose the orientations in the world to try, one of each class of equal ones. Shape=(n, 3, 3)."""
    symmetry = model.symmetry
    if symmetry.sphere:
        return np.eye(3)[None]
    x, y, z = np.eye(3)
    sides = [rotation_about(x, turn) for turn in (0.0, math.pi / 2, math.pi, -math.pi / 2)]
    sides += [rotation_about(y, turn) for turn in (math.pi / 2, -math.pi / 2)]
    headings = [rotation_about(z, 2 * math.pi * k / HEADINGS) for k in range(HEADINGS)]
    resting = [turn @ side for side in sides for turn in headings]
    group = symmetry.members(12)[:, :3, :3]
    kept: list[Array] = []
    for number, turn in enumerate([*resting, *spread_rotations(ORIENTATIONS)]):
        nearest = math.radians(14.0 if number < len(resting) else 24.0)
        # tr(A^T B) = 1 + 2 cos(angle), for every kept orientation and every member of the group at once.
        if kept:
            closest = np.einsum("nij,gij->ng", np.array(kept), turn @ group).max()
            if closest > 1.0 + 2.0 * math.cos(nearest):
                continue
        kept.append(turn)
    return np.array(kept)


def register(model: ObjectModel, turns: Array, frame: RgbdFrame, mask: NDArray[np.bool_]) -> Array:
    """Estimate T_camera_object, Shape=(4, 4), by the best fit to a mask, not empty, with some depth.

    `turns`, Shape=(n, 3, 3), are orientations in the world to try, from `start_orientations`.
    """
    depth, lens, robot = frame.depth, frame.lens, robot_mask(frame)
    size = box_of(mask, 0)
    extent = max(size[1] - size[0], size[3] - size[2])
    box = box_of(mask, max(4, extent // 4))
    coarse = crop_patch(depth, mask, robot, lens, box, COARSE_PIXELS)
    if not (coarse.mask & (coarse.depth > 0)).any():
        coarse = crop_patch(depth, mask, robot, lens, box, 10**9)
    start = _guess_center(model, coarse)
    found: list[tuple[float, int, Array]] = []
    for turn in frame.T_world_camera[:3, :3].T @ turns:
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = turn, start - turn @ model.pivot
        pose = kernels.shift_onto_mask(pose, model.solids, coarse, kernels.ROUNDS)
        pose = align(pose, model.pivot, model.solids, coarse, COARSE_STEPS, WIDE_M, TIGHT_M, OUTLINE, 0.0)
        tally = kernels.count_agreement(pose, model.solids, coarse, MARGIN_M)
        found.append((misfit(tally), len(found), pose))
    found.sort(key=lambda item: item[:2])
    fine = crop_patch(depth, mask, robot, lens, box, FINE_PIXELS)
    best = (math.inf, np.eye(4))
    for _, _, pose in _drop_duplicates(found, KEPT):
        pose = align(pose, model.pivot, model.solids, fine, FINE_STEPS, 2 * TIGHT_M, TIGHT_M, OUTLINE, 0.0)
        score = misfit(kernels.count_agreement(pose, model.solids, fine, MARGIN_M))
        if score < best[0]:
            best = (score, pose)
    return best[1]


def misfit(tally: Array) -> float:
    """Compute the share of the picture that a pose does not explain, from `count_agreement`; 0 is perfect.

    Occluded parts cost a little, or the object could hide behind the hand; so do small depth errors.
    """
    bad = tally[kernels.WRONG] + tally[kernels.UNCOVERED] + tally[kernels.FREE]
    total = tally[kernels.AGREE] + bad
    if total == 0.0:
        return math.inf
    return float((bad + 0.5 * tally[kernels.RESIDUAL] + 0.1 * tally[kernels.HIDDEN]) / total)


def _drop_duplicates(found: list[tuple[float, int, Array]], limit: int) -> list[tuple[float, int, Array]]:
    """Keep the best poses, without those that converged to the same pose as a better one."""
    kept: list[tuple[float, int, Array]] = []
    for item in found:
        if all(np.abs(item[2] - other[2]).max() > 0.03 for other in kept):
            kept.append(item)
        if len(kept) == limit:
            break
    return kept


def _guess_center(model: ObjectModel, patch: ImagePatch) -> Array:
    """Guess the object's centre, Shape=(3,) m: a sixth of its diameter behind the middle of its mask."""
    rows, columns = np.nonzero(patch.mask & (patch.depth > 0))
    z = float(np.median(patch.depth[rows, columns])) + model.diameter / 6
    pixel = np.array([columns.mean(), rows.mean()])
    return np.append((pixel - patch.lens[2:]) / patch.lens[:2] * z, z)
