"""Tracks all objects of a task in a camera's pictures: masks first, then a tracker for each object, then the hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import mujoco
import numpy as np

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.object_model import ObjectModel, from_trial
from coral.contact.perception.tracked_object import TrackedObject
from coral.contact.perception.tracked_world import nominal_pose
from coral.contact.perception.tracker import PoseEstimate, PoseTracker
from coral.contact.perception.tracker_registry import TrackerChoice
from coral.contact.real_scenes.hand_mask import HandMask, HandReading
from coral.contact.real_scenes.masks.mask_source import MaskSource, make_masks
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.observation import Array
from coral.contact.scene.trial import Trial


class ObjectTracking:
    """Estimates the poses of several objects, picture by picture. Nothing in it knows where they truly are."""

    def __init__(
        self, models: Mapping[str, ObjectModel], make: Callable[[str], PoseTracker], masks: MaskSource
    ) -> None:
        self.models, self._masks = models, masks
        self._hand = HandMask()
        self._objects = {name: TrackedObject(make(name)) for name in models}
        self._poses: dict[str, Array] = {}
        self.in_hand: dict[str, Array] = {}
        """T_tool_object, Shape=(4, 4), of each object that the fingers hold; it is known unseen, too."""

    def update(self, frame: RgbdFrame, hand: HandReading | None = None) -> dict[str, PoseEstimate]:
        """Estimate the poses of all objects in the next picture; the hand covers objects, and carries what it holds.

        Raises:
            InputError: The picture cannot be segmented.
            TrackerFailed: A tracker failed.
        """
        if hand is not None:
            frame = self._hand.label(frame, hand)
        masks = self._masks.segment(frame, self._poses)
        nothing = np.zeros(frame.depth.shape, bool)
        found = {}
        for name, one in self._objects.items():
            carried = one.at(hand.T_world_tool, frame.time_s) if hand is not None and one.held else None
            found[name] = one.tracker.track(frame, masks.get(name, nothing), carried)
            if hand is not None:
                self._follow_hand(name, found[name], hand, frame.time_s)
        self._poses = {name: one.T_world_object for name, one in found.items() if not one.lost}
        return found

    def _follow_hand(self, name: str, estimate: PoseEstimate, hand: HandReading, time_s: float) -> None:
        """Decide whether the hand holds the object, and update where in the hand it is."""
        one, tool = self._objects[name], hand.T_world_tool
        if not estimate.lost:
            one.measure(estimate, tool, time_s)
        elif one.motion is None:
            return
        one.feel(self.models[name], tool, hand.opening_m, hand.wanted_m, time_s)
        if one.held:
            self.in_hand[name] = one.known.predict(time_s)
        else:
            self.in_hand.pop(name, None)

    def close(self) -> None:
        """Release the trackers."""
        for one in self._objects.values():
            one.tracker.close()


def track_objects(trial: Trial, choice: TrackerChoice, masks: str) -> ObjectTracking:
    """Make the tracking of a trial's objects; `masks` is what segments the pictures, as `--masks` takes it.

    Raises:
        InputError: There are no such masks.
        TrackerFailed: No tracker can be made.
    """
    choice.check()
    models = object_models(trial)
    segmented = make_masks(masks, trial, models)
    return ObjectTracking(models, lambda name: choice.make(models[name], nominal_pose(trial, name)), segmented)


def object_models(trial: Trial) -> dict[str, ObjectModel]:
    """Return the models of a trial's objects."""
    spec = mujoco.MjSpec()
    add_scene(spec, trial)
    scene = spec.compile()
    return {name: from_trial(scene, trial, name) for name in trial.objects}
