"""Accuracy of a tracker on a recorded scene whose true poses are known, by the measures of its field."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseEstimate, PoseTracker
from coral.contact.real_scenes.bop_scene import BopScene
from coral.contact.real_scenes.masks.mask_source import MaskSource
from coral.contact.real_scenes.pose_error import add, add_s, mssd
from coral.contact.real_scenes.tracking_accuracy import MakeTracker, measured_share, pose_error, visible_share

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Estimate = Callable[[RgbdFrame, Mask], PoseEstimate]
SHARES = np.linspace(0.05, 0.5, 10)
"""Thresholds of MSSD, in diameters, over which BOP averages the recall."""
ENOUGH = 0.1
"""Objects with a smaller visible share are left out, as in BOP."""


@dataclass(frozen=True)
class RecordedPose:
    """One estimate in one picture."""

    picture: int
    number: int
    """The object."""
    followed: bool
    """Whether it was tracked from the picture before; else it was found afresh."""
    visible: float
    """Visible share of the object, at its true pose."""
    estimate: PoseEstimate
    mm: float
    deg: float
    """Errors modulo symmetry."""
    add_share: float
    mssd_share: float
    """ADD, or ADD-S of a symmetric object, and MSSD, in diameters of the object."""
    seconds: float
    """Time of the estimate."""


@dataclass(frozen=True)
class RecordedAccuracy:
    """The accuracy for one object in one scene. Errors are modulo the object's symmetry."""

    object: int
    followed: bool
    """Whether poses were tracked from picture to picture, or found afresh in each."""
    poses: int
    visible: float
    """Median of the visible share."""
    mm: float | None
    deg: float | None
    """Median errors of the poses that were not reported as lost; None if all were."""
    mm_95: float | None
    deg_95: float | None
    """Bounds on 95 % of the errors."""
    add_recall: float
    """Share of the poses whose ADD (ADD-S of a symmetric object) is below a tenth of the diameter; lost ones fail."""
    mssd_recall: float
    """Average share of the poses whose MSSD is below 0.05 to 0.5 diameters (AR_MSSD of BOP); lost ones fail."""
    lost: int
    """Poses that the tracker reported as lost."""
    false: int
    """Poses with an ADD above a tenth of the diameter that it did not report as lost."""
    seconds: float
    """Median time of an estimate."""


class SceneTracking:
    """Finds every object afresh in each picture of a scene, and follows it through successive pictures.

    Args:
        scene: The scene.
        make: Makes a tracker of an object.
        masks: Segments the pictures, in which the objects are named by their numbers; None for true masks. Each object
            is then in the scene once, at most.
    """

    def __init__(self, scene: BopScene, make: MakeTracker, masks: MaskSource | None = None) -> None:
        self._scene, self._make, self._masks = scene, make, masks
        self._models = {number: scene.model(number) for number in scene.objects}
        self._known: dict[str, Array] = {}
        self._following: dict[int, PoseTracker] = {}
        self._last = -2

    def poses(self, picture: int, frame: RgbdFrame) -> list[RecordedPose]:
        """Estimate the poses of the objects in the next picture."""
        if picture != self._last + 1:
            self.close()
        self._last = picture
        placed = [one.number for one in self._scene.placed[picture]]
        masks = None if self._masks is None else self._masks.segment(frame, self._known)
        found = []
        for k, number in enumerate(placed):
            model, truth = self._models[number], self._scene.truth(picture, k)
            if masks is None:
                mask = frame.mask(str(k))
                visible = visible_share(model, frame, mask, truth)
            else:
                mask = masks.get(str(number), np.zeros(frame.depth.shape, bool))
                visible = measured_share(model, frame, truth)
            if visible < ENOUGH:
                continue
            fresh = self._make(model)
            estimate, seconds = _timed(fresh.register, frame, mask)
            found.append(judge_pose(picture, model, number, estimate, truth, False, visible, seconds))
            follower = self._following.get(number)
            if follower is not None:
                estimate, seconds = _timed(follower.track, frame, mask)
                found.append(judge_pose(picture, model, number, estimate, truth, True, visible, seconds))
            if estimate.lost:
                self._known.pop(str(number), None)
            else:
                self._known[str(number)] = estimate.T_world_object
            if follower is None and placed.count(number) == 1:  # else it is not known which of them is followed
                self._following[number] = fresh
            else:
                fresh.close()
        return found

    def close(self) -> None:
        """Release the trackers."""
        for tracker in self._following.values():
            tracker.close()
        self._following.clear()


def judge_pose(
    picture: int,
    model: ObjectModel,
    number: int,
    estimate: PoseEstimate,
    truth: Array,
    followed: bool,
    visible: float,
    seconds: float,
) -> RecordedPose:
    """Compare an estimate with the true pose."""
    pose = estimate.T_world_object
    mm, deg = pose_error(model, pose, truth)
    symmetric = len(model.symmetry.members(2)) > 1
    mean = add_s(pose, truth, model.points) if symmetric else add(pose, truth, model.points)
    worst = mssd(pose, truth, model.points, model.symmetry)
    return RecordedPose(
        picture, number, followed, visible, estimate, mm, deg, mean / model.diameter, worst / model.diameter, seconds
    )


def summarize_poses(poses: Iterable[RecordedPose]) -> list[RecordedAccuracy]:
    """Summarise estimates by object, and by whether they were found afresh or followed."""
    groups: dict[tuple[int, bool], list[RecordedPose]] = {}
    for one in poses:
        groups.setdefault((one.number, one.followed), []).append(one)
    return [_summary(*key, each) for key, each in sorted(groups.items())]


def _summary(number: int, followed: bool, poses: list[RecordedPose]) -> RecordedAccuracy:
    lost = np.array([one.estimate.lost for one in poses])
    errors = np.array([(one.mm, one.deg) for one in poses if not one.estimate.lost])
    (mm, deg), (mm_95, deg_95) = (
        np.percentile(errors, share, 0).tolist() if len(errors) else (None, None) for share in (50, 95)
    )
    near = np.array([one.add_share for one in poses]) < 0.1
    shares = np.where(lost, np.inf, [one.mssd_share for one in poses])
    return RecordedAccuracy(
        object=number,
        followed=followed,
        poses=len(poses),
        visible=float(np.median([one.visible for one in poses])),
        mm=mm,
        deg=deg,
        mm_95=mm_95,
        deg_95=deg_95,
        add_recall=float((near & ~lost).mean()),
        mssd_recall=float((shares[:, None] < SHARES).mean()),
        lost=int(lost.sum()),
        false=int((~near & ~lost).sum()),
        seconds=float(np.median([one.seconds for one in poses])),
    )


def _timed(estimate: Estimate, frame: RgbdFrame, mask: Mask) -> tuple[PoseEstimate, float]:
    begin = time.perf_counter()
    return estimate(frame, mask), time.perf_counter() - begin
