"""Loss and recovery of an object that leaves the view for a second or is covered by the hand."""

from __future__ import annotations

import time
from contextlib import closing
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.object_model import from_trial
from coral.contact.real_scenes.benchmark_motions import MotionSample, motion_of
from coral.contact.real_scenes.posed_scene import PosedScene
from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg, MakeTracker
from coral.contact.scene.geometry import rotation_about
from coral.contact.scene.rigid_transform import pose_matrix
from coral.contact.scene.trial import Trial

Array = NDArray[np.float64]
How = Literal["out of view", "covered"]
_SECONDS = 1.0


@dataclass(frozen=True)
class TrackingLoss:
    """The loss and recovery of one object."""

    task: str
    object: str
    """Name of the object."""
    how: How
    """"out of view": removed, and put back 8 cm farther with a rotation of 40 degrees; or "covered": moved by 3 cm
    behind a hand in front of the camera."""
    noticed_frames: int
    """Pictures until the tracker reported the loss, counting the first one without the object as 1; 0 if it never did.
    """
    reported: float
    """Share of the pictures without the object in which it was reported as lost."""
    reason: str
    """Reason that the tracker gave."""
    recovered_frames: int
    """Pictures until it reported a pose again, counted in the same way."""
    mm: float
    deg: float
    """Error one second later, modulo symmetry."""
    slowest_s: float
    """Longest update during that time."""


def measure_loss(trial: Trial, make: MakeTracker, cfg: AccuracyCfg, how: How) -> TrackingLoss:
    """Track the first object of a trial for a second, remove it for a second, and put it back for a second."""
    stage = PosedScene(trial, cfg.camera, cfg.noise, colours=cfg.colours)
    name = trial.task.objects[0].name
    model = from_trial(stage.model, trial, name)
    start = motion_of(trial).at(0.0)
    rng = np.random.default_rng([trial.seed, 2])
    aside = MotionSample(start.objects, pose_matrix(start.tool[:3, :3], np.array([-0.5, 0.3, 0.5])), 0.04)
    gone, after = _poses_while_gone(stage, aside, name, how)
    count = round(_SECONDS / cfg.period_s)
    lost: list[bool] = []
    reason, slowest = "", 0.0
    with closing(make(model)) as tracker:
        for k in range(3 * count):
            moment = (aside, gone, after)[k // count]
            frame = stage.take(moment, rng, k * cfg.period_s)
            mask = frame.mask(name)
            begin = time.perf_counter()
            estimate = tracker.track(frame, mask) if k else tracker.register(frame, mask)
            slowest = max(slowest, time.perf_counter() - begin)
            lost.append(estimate.lost)
            reason = reason or estimate.reason
    shift, turn = model.symmetry.difference(estimate.T_world_object, after.objects[name])
    away, back = lost[count : 2 * count], lost[2 * count :]
    return TrackingLoss(
        trial.task.name,
        name,
        how,
        away.index(True) + 1 if any(away) else 0,
        sum(away) / count,
        reason,
        0 if all(back) else back.index(False) + 1,
        1e3 * shift,
        float(np.degrees(turn)),
        slowest,
    )


def _poses_while_gone(stage: PosedScene, aside: MotionSample, name: str, how: How) -> tuple[MotionSample, MotionSample]:
    """Return the poses while the object is away, and after its return."""
    here = aside.objects[name]
    if how == "out of view":
        away = pose_matrix(here[:3, :3], here[:3, 3] + np.array([0.0, 0.0, -5.0]))
        turn = rotation_about(np.array([0.0, 0.0, 1.0]), np.radians(40.0))
        there = pose_matrix(turn @ here[:3, :3], here[:3, 3] + np.array([0.08, 0.0, 0.0]))
        return (
            MotionSample(aside.objects | {name: away}, aside.tool, aside.opening_m),
            MotionSample(aside.objects | {name: there}, aside.tool, aside.opening_m),
        )
    there = pose_matrix(here[:3, :3], here[:3, 3] + np.array([0.03, 0.0, 0.0]))
    camera = stage.camera.T_world_camera
    sight = here[:3, 3] - camera[:3, 3]
    distance = np.linalg.norm(sight)
    sight /= distance
    side = np.cross([0.0, 0.0, 1.0], sight)
    side /= np.linalg.norm(side)
    # The palm's broad side faces the lens: its height is across the line of sight, fingers up.
    hand = pose_matrix(np.stack([sight, side, np.cross(sight, side)], 1), camera[:3, 3] + 0.16 * sight)
    hand[:3, 3] += 0.07 * hand[:3, 2]
    objects = aside.objects | {name: there}
    return MotionSample(objects, hand, 0.0), MotionSample(objects, aside.tool, aside.opening_m)
