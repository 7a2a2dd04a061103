"""The embedded pose tracker: registration first, then alignment from picture to picture."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, NonNegative, Positive
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.confidence import ConfidenceCfg, assess_pose, is_unseen, patch_around, robot_mask
from coral.contact.perception.image_patch import ImagePatch
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.pose_fit import align_pose, count_agreement, shift_onto_mask
from coral.contact.perception.registration import RegistrationCfg, misfit, register, start_orientations
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.scene.geometry import rotation_about, rotation_angle, rotation_from_vector, rotation_vector
from coral.contact.scene.rigid_transform import inverse_transform, pose_matrix

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TrackerCfg:
    """Weights and thresholds, chosen by measurement on the six tasks' motions (docs/research/tracking.md)."""

    pixels: Count = 12000
    """Pixels of the patch that is aligned: all of an object at 320 x 240."""
    steps: Count = 8
    """Gauss-Newton steps."""
    wide_m: Positive = 0.025
    """Depth residuals larger than this are ignored in the first step."""
    tight_m: Positive = 0.008
    """Depth residuals larger than this are ignored in the last step: four standard deviations at 1 m."""
    outline: NonNegative = 2.0
    """Weight of an outline pixel relative to a depth pixel."""
    hold: NonNegative = 3.0
    """Weight of the predicted pose, in pixels: it determines what a small visible part leaves open."""
    search_above: NonNegative = 0.35
    """If `misfit` is larger than this, nearby poses are tried too."""
    reluctance: NonNegative = 0.3
    """Penalty added there to the misfit for each object diameter, or radian, of distance from the guesses."""
    search_rad: Positive = 0.25
    """Rotation of those poses: half of the error that the alignment corrects by itself."""
    confidence: ConfidenceCfg = field(default_factory=ConfidenceCfg)
    """Thresholds of a lost object."""
    registration: RegistrationCfg = field(default_factory=RegistrationCfg)
    """Registration without a previous pose."""


class ModelTracker:
    """Tracks one object of known shape: minimises over T sum w_d(r) r^2 + sum w_o o^2 + hold |T - T_guess|^2.

    r is the depth residual along the drawn normal, o the distance of the drawn outline from the mask (`align_kernels`).
    Each picture is aligned from the best of several guesses: the last pose, the extrapolated one, and a hint. If the
    fit is poor, nearby poses are tried; if it stays poor, the object is registered anew.

    Args:
        model: The object.
        cfg: Weights and thresholds.
        expected: T_world_object, Shape=(4, 4): of the poses that its symmetry makes equal, the first report uses the
            one nearest to this; by default the object's axes along the world's.
    """

    name = "model"
    wants_colours = False

    def __init__(self, model: ObjectModel, cfg: TrackerCfg | None = None, expected: Array | None = None) -> None:
        self.model, self.cfg = model, cfg or TrackerCfg()
        self._turns = start_orientations(model, self.cfg.registration)
        self._reference = np.eye(4) if expected is None else expected
        self._last: Array | None = None
        self._before: Array | None = None
        self._lost = False

    def register(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> PoseEstimate:
        """Find the object without a previous pose; see `PoseTracker`."""
        if is_unseen(frame, mask, self.cfg.confidence):
            return self._report_lost("not seen")
        pose = register(
            self.model,
            self._turns,
            frame.depth,
            mask,
            frame.lens,
            frame.T_world_camera,
            robot_mask(frame, self.cfg.confidence),
            self.cfg.registration,
        )
        return self._assess(frame, self._patch(frame, mask, [pose]), pose, registered=True)

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_], guess: Array | None = None) -> PoseEstimate:
        """Track the object, or find it again after a loss; the hint is one more guess. See `PoseTracker`."""
        if self._last is None:
            return self.register(frame, mask)
        if is_unseen(frame, mask, self.cfg.confidence):
            return self._report_lost("not seen")
        camera = inverse_transform(frame.T_world_camera)
        starts = [camera @ self._last]
        if self._before is not None:
            starts.append(camera @ _extrapolate(self._last, self._before))
        if guess is not None:
            starts.append(camera @ guess)
        patch = self._patch(frame, mask, starts)
        if self._lost:
            starts.append(shift_onto_mask(patch, self.model, starts[0]))
        pose = self._align(
            patch, min(starts, key=lambda start: misfit(count_agreement(patch, self.model, start, 0.03)))
        )
        if self._misfit(patch, pose) > self.cfg.search_above:
            pose = self._search(patch, [*starts, pose])
        estimate = self._assess(frame, patch, pose)
        if estimate.reason == "does not fit":
            estimate = self.register(frame, mask)
        return estimate

    def close(self) -> None:
        """See `PoseTracker`; there is nothing to release."""

    def _patch(self, frame: RgbdFrame, mask: NDArray[np.bool_], poses: list[Array]) -> ImagePatch:
        return patch_around(frame, mask, self.model, poses, self.cfg.confidence, self.cfg.pixels)

    def _align(self, patch: ImagePatch, pose: Array) -> Array:
        cfg = self.cfg
        return align_pose(patch, self.model, pose, cfg.steps, cfg.wide_m, cfg.tight_m, cfg.outline, cfg.hold)

    def _misfit(self, patch: ImagePatch, pose: Array) -> float:
        return misfit(count_agreement(patch, self.model, pose, self.cfg.confidence.margin_m))

    def _search(self, patch: ImagePatch, poses: list[Array]) -> Array:
        """Align from several guesses, and from the first one rotated slightly about every axis; return the best fit."""
        guesses = list(poses)
        middle = poses[0][:3, :3] @ self.model.pivot + poses[0][:3, 3]
        for axis in np.eye(3):
            for sign in (1.0, -1.0):
                turn = rotation_about(axis, sign * self.cfg.search_rad)
                guesses.append(pose_matrix(turn @ poses[0][:3, :3], turn @ (poses[0][:3, 3] - middle) + middle))
        found = [self._align(patch, guess) for guess in guesses]
        return min(found, key=lambda pose: self._misfit(patch, pose) + self.cfg.reluctance * self._effort(pose, poses))

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
        cfg = self.cfg.confidence
        following = self._last is not None and not self._lost
        assessment = assess_pose(self.model, patch, pose, cfg, following)
        if assessment.reason:
            return self._report_lost(assessment.reason, assessment.visible)
        world = self.model.symmetry.nearest(frame.T_world_camera @ pose, self._reference)
        self._before = None if registered or self._lost else self._last
        self._last = self._reference = world
        self._lost = False
        return PoseEstimate(world, assessment.confidence, False, assessment.visible, "", registered)

    def _report_lost(self, reason: str, visible: float = 0.0) -> PoseEstimate:
        """Report the object as lost."""
        self._lost, self._before = True, None
        return PoseEstimate(self._reference, 0.0, True, visible, reason)


def _extrapolate(last: Array, before: Array) -> Array:
    """Extrapolate T_world_object to now, at the velocity between the last two pictures."""
    turn = rotation_from_vector(rotation_vector(last[:3, :3] @ before[:3, :3].T))
    return pose_matrix(turn @ last[:3, :3], 2 * last[:3, 3] - before[:3, 3])
