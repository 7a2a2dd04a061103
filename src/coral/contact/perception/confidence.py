"""Confidence in a pose: how well it explains the picture from which it was estimated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import agreement_kernels as kernels
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.image_patch import ImagePatch, box_of, crop_patch, project, robot_mask
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseEstimate
from coral.contact.scene.observation import Array

# Chosen by measurement on the six tasks' motions (docs/research/tracking.md).
MIN_PIXELS = 30
"""An object with fewer depth pixels in its mask counts as not seen."""
MIN_VISIBLE = 0.1
"""An object counts as covered if a smaller share of its drawing is visible. Confidence falls below twice this
share: with less than a fifth visible, one pose in ten is more than a centimetre off."""
LOST_BELOW = 0.6
"""A tracked object with less confidence counts as lost; half covered, a pose 4 cm off still reaches 0.5."""
FOUND_ABOVE = 0.9
"""A lost object with more confidence counts as found; a box explains a can of its size by 0.87."""
FOUND_VISIBLE = 0.25
"""Share of the drawing that must be visible for that: a smaller part fits in many places."""
MARGIN_M = 0.012
"""Depths with a smaller difference agree: five standard deviations at 1 m."""


@dataclass(frozen=True)
class PoseAssessment:
    """Reliability of a pose."""

    confidence: float
    """From 0 to 1."""
    visible: float
    """Visible share of the object's drawing."""
    reason: str
    """"" if the pose is reliable; else "not seen", "covered" or "does not fit"."""


def is_unseen(frame: RgbdFrame, mask: NDArray[np.bool_]) -> bool:
    """Check whether too few pixels of the mask have depth for assessing a pose.

    Raises:
        ValueError: The mask does not fit the picture.
    """
    if mask.shape != frame.depth.shape:
        raise ValueError(f"mask of shape {mask.shape} for a picture of shape {frame.depth.shape}")
    return int(np.count_nonzero(mask & (frame.depth > 0))) < MIN_PIXELS


def patch_around(
    frame: RgbdFrame, mask: NDArray[np.bool_], model: ObjectModel, poses: list[Array], pixels: int
) -> ImagePatch:
    """Crop the picture to the mask and to the object's drawings at some poses (T_camera_object)."""
    points = model.points[::10]
    corners = [project(points @ pose[:3, :3].T + pose[:3, 3], frame.lens) for pose in poses]
    box = box_of(mask, 8, np.concatenate(corners))
    return crop_patch(frame.depth, mask, robot_mask(frame), frame.lens, box, pixels)


def assess_pose(model: ObjectModel, patch: ImagePatch, pose: Array, following: bool) -> PoseAssessment:
    """Assess how well a pose, T_camera_object, Shape=(4, 4), explains the picture.

    A newly found pose, of an object that was not tracked up to now (`following`), must meet higher thresholds.
    """
    needed = LOST_BELOW if following else FOUND_ABOVE
    tally = kernels.count_agreement(pose, model.solids, patch, MARGIN_M)
    seen = float(tally[kernels.AGREE] + tally[kernels.WRONG])
    visible = seen / max(1.0, float(tally[kernels.DRAWN]))
    total = seen + float(tally[kernels.UNCOVERED] + tally[kernels.FREE])
    confidence = float(tally[kernels.AGREE]) / max(1.0, total)
    confidence *= min(1.0, visible / max(1e-9, 2 * MIN_VISIBLE))
    if visible < (MIN_VISIBLE if following else FOUND_VISIBLE):
        hidden = float(tally[kernels.HIDDEN]) > 0.5 * float(tally[kernels.DRAWN])
        return PoseAssessment(confidence, visible, "covered" if hidden else "does not fit")
    return PoseAssessment(confidence, visible, "" if confidence >= needed else "does not fit")


class PoseBelief:
    """What a tracker believes of an object's pose, and whether it has lost it; `expected` is as in `ModelTracker`."""

    def __init__(self, model: ObjectModel, expected: Array | None) -> None:
        self._model = model
        self.pose = np.eye(4) if expected is None else expected
        """T_world_object, Shape=(4, 4): the last that was relied on, before the first one the expected."""
        self.found = self.lost = False
        """Whether it was ever found, and whether it was lost since."""

    @property
    def follows(self) -> bool:
        """Return whether the object was tracked up to now."""
        return self.found and not self.lost

    def update(self, frame: RgbdFrame, patch: ImagePatch, pose: Array, registered: bool) -> PoseEstimate:
        """Assess a pose (T_camera_object), and keep it if it is reliable."""
        assessment = assess_pose(self._model, patch, pose, self.follows)
        if assessment.reason:
            return self.lose(assessment.reason, assessment.visible)
        self.pose = self._model.symmetry.nearest(frame.T_world_camera @ pose, self.pose)
        self.found, self.lost = True, False
        return PoseEstimate(self.pose, assessment.confidence, False, assessment.visible, "", registered)

    def lose(self, reason: str, visible: float = 0.0) -> PoseEstimate:
        """Report the object as lost."""
        self.lost = True
        return PoseEstimate(self.pose, 0.0, True, visible, reason)
