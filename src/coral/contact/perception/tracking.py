"""The embedded pose tracker: registration, then alignment from picture to picture, with a confidence of its own."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception import align_kernels as kernels
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.registration import RegistrationCfg, misfit, orientations, register
from coral.contact.perception.rotation import from_vector, inverse, vector
from coral.contact.perception.shapes import ObjectModel
from coral.contact.perception.tracker import Estimate
from coral.contact.perception.view import View, box_of, cut, project

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TrackerCfg:
    """Chosen by measurement on the six tasks' motions (docs/contact-perception.md)."""

    pixels: int = 12000
    """Of the cut-out that is aligned: all of an object at 320 x 240."""
    steps: int = 8
    wide_m: float = 0.025
    """Depth residuals beyond this do not count in the first step."""
    tight_m: float = 0.008
    """Nor beyond this in the last one: four standard deviations at 1 m."""
    outline: float = 2.0
    """Weight of an outline pixel against a depth pixel."""
    margin_m: float = 0.012
    """Depths that differ by less agree."""
    min_pixels: int = 30
    """A smaller mask is not looked at."""
    min_visible: float = 0.08
    """Share of the object's drawing that must be seen."""
    lost_below: float = 0.6
    """Confidence below which the object counts as lost."""
    found_above: float = 0.75
    """Confidence above which it counts as found again."""
    registration: RegistrationCfg = field(default_factory=RegistrationCfg)


class ModelTracker:
    """Tracks one object whose shape is known.

    Args:
        model: The object.
        cfg: How.
    """

    def __init__(self, model: ObjectModel, cfg: TrackerCfg | None = None) -> None:
        self.model, self.cfg = model, cfg or TrackerCfg()
        self.name = "model"
        self._turns = orientations(model, self.cfg.registration)
        self._last: Array | None = None
        self._before: Array | None = None
        self._lost = False

    def register(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> Estimate:
        """Find the object without knowing where it was; see `PoseTracker`."""
        reason = self._unseen(frame, mask)
        if reason:
            return self._give_up(reason)
        pose = register(self.model, self._turns, frame.depth, mask, frame.lens, frame.T_world_camera,
                        self.cfg.registration)
        return self._judge(frame, mask, pose, registered=True)

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> Estimate:
        """Follow the object; where it was lost, find it again. See `PoseTracker`."""
        if self._last is None:
            return self.register(frame, mask)
        reason = self._unseen(frame, mask)
        if reason:
            return self._give_up(reason)
        camera = inverse(frame.T_world_camera)
        starts = [camera @ self._last]
        if self._before is not None and not self._lost:
            starts.append(camera @ _ahead(self._last, self._before))
        view = self._cut(frame, mask, starts)
        if self._lost:
            starts.append(view.place(self.model, starts[0]))
        pose = self._align(view, min(starts, key=lambda start: misfit(view.count(self.model, start, 0.03))))
        estimate = self._judge(frame, mask, pose, view=view)
        if estimate.lost and estimate.reason != "covered":
            # Before all orientations are tried: the last one, put where the mask now is.
            pose = self._align(view, view.place(self.model, starts[0]))
            estimate = self._judge(frame, mask, pose, view=view)
            if estimate.lost:
                estimate = self.register(frame, mask)
        return estimate

    def _unseen(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> str:
        """Why the object cannot be looked for, or ""."""
        if mask.shape != frame.depth.shape:
            raise ValueError(f"mask of shape {mask.shape} for a picture of shape {frame.depth.shape}")
        seen = int(np.count_nonzero(mask & (frame.depth > 0)))
        return "" if seen >= self.cfg.min_pixels else "not seen"

    def _cut(self, frame: RgbdFrame, mask: NDArray[np.bool_], poses: list[Array]) -> View:
        """The cut-out that holds the mask and the object at some poses (T_camera_object)."""
        corners = self.model.points[::10]
        pixels = [project(corners @ pose[:3, :3].T + pose[:3, 3], frame.lens) for pose in poses]
        return cut(frame.depth, mask, frame.lens, box_of(mask, 8, np.concatenate(pixels)), self.cfg.pixels)

    def _align(self, view: View, pose: Array) -> Array:
        cfg = self.cfg
        return view.align(self.model, pose, cfg.steps, cfg.wide_m, cfg.tight_m, cfg.outline)


    def _judge(
        self, frame: RgbdFrame, mask: NDArray[np.bool_], pose: Array, *, registered: bool = False,
        view: View | None = None,
    ) -> Estimate:
        """Confidence of a pose (T_camera_object); keeps it if it is good enough."""
        tally = (view or self._cut(frame, mask, [pose])).count(self.model, pose, self.cfg.margin_m)
        seen = tally[kernels.AGREE] + tally[kernels.WRONG]
        total = seen + tally[kernels.UNCOVERED] + tally[kernels.FREE]
        visible = float(seen / max(1.0, tally[kernels.DRAWN]))
        confidence = float(tally[kernels.AGREE] / max(1.0, total))
        confidence *= min(1.0, visible / (2 * self.cfg.min_visible))
        if visible < self.cfg.min_visible:
            return self._give_up("covered", confidence, visible)
        if confidence < (self.cfg.found_above if self._lost else self.cfg.lost_below):
            return self._give_up("does not fit", confidence, visible)
        world = frame.T_world_camera @ pose
        if self._last is not None:
            world = self.model.symmetry.nearest(world, self._last)
        self._before = None if registered or self._lost else self._last
        self._last, self._lost = world, False
        return Estimate(world, confidence, False, visible, "", registered)

    def _give_up(self, reason: str, confidence: float = 0.0, visible: float = 0.0) -> Estimate:
        """Report the object as lost."""
        self._lost, self._before = True, None
        last = np.eye(4) if self._last is None else self._last
        return Estimate(last, confidence, True, visible, reason)


def _ahead(last: Array, before: Array) -> Array:
    """Where the object is now if it goes on as it did between the last two pictures. T_world_object."""
    pose = last.copy()
    pose[:3, :3] = from_vector(vector(last[:3, :3] @ before[:3, :3].T)) @ last[:3, :3]
    pose[:3, 3] += last[:3, 3] - before[:3, 3]
    return pose
