"""The embedded pose tracker: registration first, then alignment from picture to picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.agreement_kernels import ROUNDS, count_agreement, shift_onto_mask
from coral.contact.perception.align_kernels import align
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.confidence import MARGIN_M, PoseBelief, is_unseen, patch_around
from coral.contact.perception.image_patch import ImagePatch
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.registration import misfit, register, start_orientations
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.scene.geometry import (
    inverse_transform,
    pose_matrix,
    rotation_about,
    rotation_angle,
    rotation_from_vector,
    rotation_vector,
)
from coral.contact.scene.observation import Array

# Weights and thresholds, chosen by measurement on the six tasks' motions (docs/research/tracking.md).
PIXELS = 12000
"""Pixels of the patch that is aligned: all of an object at 320 x 240."""
STEPS = 8
"""Gauss-Newton steps."""
WIDE_M = 0.025
"""Depth residuals larger than this are ignored in the first step."""
TIGHT_M = 0.008
"""Depth residuals larger than this are ignored in the last step: four standard deviations at 1 m."""
OUTLINE = 2.0
"""Weight of an outline pixel relative to a depth pixel."""
HOLD = 3.0
"""Weight of the predicted pose, in pixels: it determines what a small visible part leaves open."""
SEARCH_ABOVE = 0.35
"""If `misfit` is larger than this, nearby poses are tried too."""
RELUCTANCE = 0.3
"""Penalty added there to the misfit for each object diameter, or radian, of distance from the guesses."""
SEARCH_RAD = 0.25
"""Rotation of those poses: half of the error that the alignment corrects by itself."""


class ModelTracker:
    """Tracks one object of known shape: minimises over T sum w_d(r) r^2 + sum w_o o^2 + hold |T - T_guess|^2.

    r is the depth residual along the drawn normal, o the distance of the drawn outline from the mask (`align_kernels`).
    Each picture is aligned from the best of several guesses: the last pose, the extrapolated one, and a hint. If the
    fit is poor, nearby poses are tried; if it stays poor, the object is registered anew.

    Of the poses that the object's symmetry makes equal, the first report uses the one nearest to `expected`,
    T_world_object, Shape=(4, 4); by default the object's axes along the world's.
    """

    def __init__(self, model: ObjectModel, expected: Array | None = None) -> None:
        self.model = model
        self._turns = start_orientations(model)
        self.belief = PoseBelief(model, expected)
        self._before: Array | None = None

    def register(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> PoseEstimate:
        """Find the object, whose mask has Shape=(H, W), without a previous pose."""
        if is_unseen(frame, mask):
            return self._lose()
        pose = register(self.model, self._turns, frame, mask)
        return self._assess(frame, self._patch(frame, mask, [pose]), pose, registered=True)

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_], guess: Array | None = None) -> PoseEstimate:
        """Track the object, or find it again after a loss; the hint is one more guess. See `PoseTracker`."""
        if not self.belief.found:
            return self.register(frame, mask)
        if is_unseen(frame, mask):
            return self._lose()
        camera = inverse_transform(frame.T_world_camera)
        last = self.belief.pose
        starts = [camera @ last]
        if self._before is not None:
            starts.append(camera @ _extrapolate(last, self._before))
        if guess is not None:
            starts.append(camera @ guess)
        patch = self._patch(frame, mask, starts)
        if self.belief.lost:
            starts.append(shift_onto_mask(starts[0], self.model.solids, patch, ROUNDS))
        pose = self._align(patch, min(starts, key=lambda start: self._misfit(patch, start, 0.03)))
        if self._misfit(patch, pose) > SEARCH_ABOVE:
            pose = self._search(patch, [*starts, pose])
        estimate = self._assess(frame, patch, pose)
        if estimate.reason == "does not fit":
            estimate = self.register(frame, mask)
        return estimate

    def close(self) -> None:
        """See `PoseTracker`; there is nothing to release."""

    def _patch(self, frame: RgbdFrame, mask: NDArray[np.bool_], poses: list[Array]) -> ImagePatch:
        return patch_around(frame, mask, self.model, poses, PIXELS)

    def _align(self, patch: ImagePatch, pose: Array) -> Array:
        model = self.model
        return np.asarray(align(pose, model.pivot, model.solids, patch, STEPS, WIDE_M, TIGHT_M, OUTLINE, HOLD))

    def _misfit(self, patch: ImagePatch, pose: Array, margin_m: float = MARGIN_M) -> float:
        return misfit(count_agreement(pose, self.model.solids, patch, margin_m))

    def _search(self, patch: ImagePatch, poses: list[Array]) -> Array:
        """Align from several guesses, and from the first one rotated slightly about every axis; return the best fit."""
        guesses = list(poses)
        middle = poses[0][:3, :3] @ self.model.pivot + poses[0][:3, 3]
        for axis in np.eye(3):
            for sign in (1.0, -1.0):
                turn = rotation_about(axis, sign * SEARCH_RAD)
                guesses.append(pose_matrix(turn @ poses[0][:3, :3], turn @ (poses[0][:3, 3] - middle) + middle))
        found = [self._align(patch, guess) for guess in guesses]
        return min(found, key=lambda pose: self._misfit(patch, pose) + RELUCTANCE * self._effort(pose, poses))

    def _effort(self, pose: Array, guesses: list[Array]) -> float:
        """Compute the distance of a pose from the nearest guess: in diameters of the object, plus radians."""
        pivot = self.model.pivot
        return min(
            float(np.linalg.norm((pose[:3, :3] - g[:3, :3]) @ pivot + pose[:3, 3] - g[:3, 3])) / self.model.diameter
            + rotation_angle(g[:3, :3], pose[:3, :3])
            for g in guesses
        )

    def _assess(self, frame: RgbdFrame, patch: ImagePatch, pose: Array, *, registered: bool = False) -> PoseEstimate:
        """Assess a pose (T_camera_object), and keep it if it is reliable."""
        before = self.belief.pose if self.belief.follows and not registered else None
        estimate = self.belief.update(frame, patch, pose, registered)
        self._before = None if estimate.lost else before
        return estimate

    def _lose(self) -> PoseEstimate:
        self._before = None
        return self.belief.lose("not seen")


def _extrapolate(last: Array, before: Array) -> Array:
    """Extrapolate T_world_object to now, at the velocity between the last two pictures."""
    turn = rotation_from_vector(rotation_vector(last[:3, :3] @ before[:3, :3].T))
    return pose_matrix(turn @ last[:3, :3], 2 * last[:3, 3] - before[:3, 3])
