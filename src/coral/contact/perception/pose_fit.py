"""Fits the pose of a known object to a patch of a picture: the alignment kernels, called with an `ObjectModel`.

Poses are T_camera_object, Shape=(4, 4).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import agreement_kernels, align_kernels
from coral.contact.perception.image_patch import ImagePatch
from coral.contact.perception.object_model import ObjectModel
from coral.contact.scene.rigid_transform import pose_matrix

Array = NDArray[np.float64]


def count_agreement(patch: ImagePatch, model: ObjectModel, T_camera_object: Array, margin_m: float) -> Array:
    """Count how well a pose explains the patch: the tally of `agreement_kernels.count_agreement`. Shape=(7,)."""
    tally = np.empty(7)
    turn, shift = T_camera_object[:3, :3].copy(), T_camera_object[:3, 3].copy()
    agreement_kernels.count_agreement(turn, shift, model.solids, patch, margin_m, tally)
    return tally


def shift_onto_mask(patch: ImagePatch, model: ObjectModel, T_camera_object: Array, rounds: int = 2) -> Array:
    """Shift a pose until the object's drawing has the centre and the depth of the mask."""
    turn, shift = T_camera_object[:3, :3].copy(), T_camera_object[:3, 3].copy()
    agreement_kernels.shift_onto_mask(turn, shift, model.solids, patch, rounds)
    return pose_matrix(turn, shift)


def align_pose(
    patch: ImagePatch,
    model: ObjectModel,
    T_camera_object: Array,
    iterations: int,
    wide_m: float,
    tight_m: float,
    outline: float,
    hold: float = 0.0,
) -> Array:
    """Improve a pose by some Gauss-Newton steps of `align_kernels.align`; see there for the arguments."""
    turn, shift = T_camera_object[:3, :3].copy(), T_camera_object[:3, 3].copy()
    align_kernels.align(turn, shift, model.pivot, model.solids, patch, iterations, wide_m, tight_m, outline, hold)
    return pose_matrix(turn, shift)
