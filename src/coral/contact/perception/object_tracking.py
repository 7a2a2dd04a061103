"""Tracks all objects of a task in a camera's pictures: masks first, then a tracker for each object."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.masks.mask_source import MaskSource
from coral.contact.perception.object_model import ObjectModel, from_trial
from coral.contact.perception.tracker import PoseEstimate, PoseTracker
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.trial import Trial

Array = NDArray[np.float64]


class ObjectTracking:
    """Estimates the poses of several objects, picture by picture. Nothing in it knows where they truly are.

    Args:
        models: The objects.
        make: Makes the tracker of an object, by its name.
        masks: Segments the pictures.
    """

    def __init__(
        self, models: Mapping[str, ObjectModel], make: Callable[[str], PoseTracker], masks: MaskSource
    ) -> None:
        self.models, self._masks = models, masks
        self._trackers = {name: make(name) for name in models}
        self._poses: dict[str, Array] = {}

    def update(self, frame: RgbdFrame) -> dict[str, PoseEstimate]:
        """Estimate the pose of every object in the next picture.

        Raises:
            InputError: The picture cannot be segmented.
            TrackerFailed: A tracker failed.
        """
        masks = self._masks.segment(frame, self._poses)
        nothing = np.zeros(frame.depth.shape, bool)
        found = {name: one.track(frame, masks.get(name, nothing)) for name, one in self._trackers.items()}
        self._poses = {name: one.T_world_object for name, one in found.items() if not one.lost}
        return found

    def close(self) -> None:
        """Release the trackers."""
        for one in self._trackers.values():
            one.close()


def object_models(trial: Trial) -> dict[str, ObjectModel]:
    """Return the models of a trial's objects."""
    spec = mujoco.MjSpec()
    add_scene(spec, trial)
    scene = spec.compile()
    return {name: from_trial(scene, trial, name) for name in trial.objects}
