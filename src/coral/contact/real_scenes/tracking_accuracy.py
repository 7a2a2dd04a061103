"""Accuracy of a tracker over a motion: pose errors, times, and registrations from scratch."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.config import Count, TimeStep
from coral.contact.perception.agreement_kernels import AGREE, DRAWN, WRONG
from coral.contact.perception.camera import Colours, RgbdCameraCfg, RgbdFrame
from coral.contact.perception.confidence import MARGIN_M, patch_around
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.perception.object_model import ObjectModel, from_trial
from coral.contact.perception.pose_fit import count_agreement
from coral.contact.perception.tracker import PoseTracker
from coral.contact.real_scenes.benchmark_motions import motion_of
from coral.contact.real_scenes.posed_scene import PosedScene
from coral.contact.scene.rigid_transform import inverse_transform
from coral.contact.scene.trial import Trial

Array = NDArray[np.float64]
ENOUGH = 0.25
"""Visible share of the object that a registration requires."""
WITHIN_MM, WITHIN_DEG = 5.0, 5.0
"""A registration with both errors smaller than these is a success."""
MakeTracker = Callable[[ObjectModel], PoseTracker]


@dataclass(frozen=True, kw_only=True)
class AccuracyCfg:
    """Settings of the measurement."""

    camera: RgbdCameraCfg
    """Camera of the pictures."""
    noise: DepthNoise | None
    """Depth noise; None for none."""
    colours: Colours = "none"
    """Whether pictures have colours: networks need them."""
    period_s: TimeStep = 0.1
    """Time between pictures: 10 Hz, the lower end of the range of closed loops."""
    registrations: Count = 8
    """Number of registrations from scratch, spread evenly over the pictures that show enough."""


@dataclass(frozen=True)
class Accuracy:
    """The accuracy for one object in one motion. Errors are modulo the object's symmetry."""

    task: str
    """Task of the motion."""
    object: str
    """Name of the object."""
    frames: int
    """Number of tracked pictures."""
    mm: float
    deg: float
    """Median error of the position and of the orientation."""
    mm_95: float
    deg_95: float
    """Bounds on 95 % of the errors."""
    lost: int
    """Number of pictures in which the tracker reported the object as lost."""
    least_visible: float
    """Smallest visible share of the object, at its true pose."""
    update_ms: float
    update_ms_95: float
    """Time of one update."""
    registrations: int
    registered: int
    """Number of registrations from scratch, and of those within the limits."""
    registration_s: float
    """Median time of a registration."""


def take_motion(trial: Trial, cfg: AccuracyCfg) -> tuple[mujoco.MjModel, list[RgbdFrame], list[Mapping[str, Array]]]:
    """Take the pictures of the motion of a task; return the scene, the pictures, and T_world_object by name in each."""
    motion = motion_of(trial)
    stage = PosedScene(trial, cfg.camera, cfg.noise, colours=cfg.colours)
    rng = np.random.default_rng([trial.seed, 1])
    times = np.arange(round(motion.duration_s / cfg.period_s) + 1) * cfg.period_s
    truths = [motion.at(float(t)) for t in times]
    frames = [stage.take(truth, rng, float(t)) for truth, t in zip(truths, times, strict=True)]
    return stage.model, frames, [truth.objects for truth in truths]


def measure_accuracy(trial: Trial, make: MakeTracker, cfg: AccuracyCfg) -> list[Accuracy]:
    """Track every object of a trial through the motion of its task."""
    scene, frames, truths = take_motion(trial, cfg)
    found = []
    for name in trial.objects:
        model = from_trial(scene, trial, name)
        with closing(make(model)) as tracker:
            _warm(tracker, frames[0].mask(name), frames[0])
        visible = [
            visible_share(model, frame, frame.mask(name), truth[name])
            for frame, truth in zip(frames, truths, strict=True)
        ]
        errors, spent, lost = [], [], 0
        with closing(make(model)) as tracker:
            for k, frame in enumerate(frames):
                mask = frame.mask(name)
                begin = time.perf_counter()
                estimate = tracker.track(frame, mask) if k else tracker.register(frame, mask)
                spent.append(time.perf_counter() - begin)
                errors.append(pose_error(model, estimate.T_world_object, truths[k][name]))
                lost += estimate.lost
        starts, start_times = [], []
        shown = np.flatnonzero(np.array(visible) >= ENOUGH)
        for k in shown[np.linspace(0, len(shown) - 1, cfg.registrations).round().astype(int)] if len(shown) else ():
            mask = frames[k].mask(name)
            with closing(make(model)) as tracker:
                begin = time.perf_counter()
                estimate = tracker.register(frames[k], mask)
                start_times.append(time.perf_counter() - begin)
            mm, deg = pose_error(model, estimate.T_world_object, truths[k][name])
            starts.append(not estimate.lost and mm < WITHIN_MM and deg < WITHIN_DEG)
        e, updates = np.array(errors), 1e3 * np.array(spent[1:])
        (mm, deg), (mm_95, deg_95) = np.median(e, 0).tolist(), np.percentile(e, 95, 0).tolist()
        found.append(
            Accuracy(
                trial.task.name,
                name,
                len(frames),
                mm,
                deg,
                mm_95,
                deg_95,
                lost,
                float(min(visible)),
                float(np.median(updates)),
                float(np.percentile(updates, 95)),
                len(starts),
                int(sum(starts)),
                float(np.median(start_times)) if start_times else 0.0,
            )
        )
    return found


def _warm(tracker: PoseTracker, mask: NDArray[np.bool_], frame: RgbdFrame) -> None:
    """Register and update once without timing: the first calls compile."""
    tracker.register(frame, mask)
    tracker.track(frame, mask)


def visible_share(model: ObjectModel, frame: RgbdFrame, mask: NDArray[np.bool_], truth: Array) -> float:
    """Compute the visible share of the object, at its true pose."""
    if not mask.any():
        return 0.0
    pose = inverse_transform(frame.T_world_camera) @ truth
    tally = count_agreement(patch_around(frame, mask, model, [pose], frame.depth.size), model, pose, MARGIN_M)
    return float((tally[AGREE] + tally[WRONG]) / max(1.0, tally[DRAWN]))


def pose_error(model: ObjectModel, estimate: Array, truth: Array) -> tuple[float, float]:
    """Compute the error in millimetres and degrees, modulo symmetry."""
    shift, turn = model.symmetry.difference(estimate, truth)
    return 1e3 * shift, math.degrees(turn)
