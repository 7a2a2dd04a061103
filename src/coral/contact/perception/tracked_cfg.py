"""The camera that watches a task, where it stands, and what is made of its pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import mujoco
import numpy as np

from coral.config import Count, NonNegative, Positive, Signed
from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, look_at
from coral.contact.perception.depth_noise import DepthNoise, DepthNoiseCfg
from coral.contact.perception.grasp_detection import GraspDetectionCfg
from coral.contact.perception.motion_filter import MotionFilterCfg
from coral.contact.perception.scene_geoms import instance_names
from coral.contact.perception.tracker_registry import TrackerCfgs, TrackerChoice, choose_tracker
from coral.contact.scene.trial import Trial
from coral.errors import InputError

Place = tuple[Signed, Signed, Signed]
EYE, TARGET = (0.05, -0.9, 0.35), (0.05, 0.0, 0.08)
"""From the robot's right across the table, low: the arm comes from behind and above, and hides least from there."""
EYES: Mapping[str, tuple[Place, Place]] = {
    "push-pick-board": ((-0.35, 0.75, 0.6), (0.05, 0.0, 0.05)),  # the hand takes the board's right-hand side
}
"""Of the tasks that are seen better from elsewhere."""
_DRAWN = (0,)
"""The robot's collision shapes stand for its looks: a little fuller, and drawn in half the time."""


@dataclass(frozen=True, kw_only=True)
class TrackedCfg(TrackerCfgs):
    """The camera, and what is made of its pictures.

    Args:
        period_s: Between two pictures.
        latency_s: From a picture to the poses in it; no more than `period_s`: one picture is worked on at a time.
        camera: The lens.
        eye_m, target_m: Where the camera is and what it looks at; by default where the task's objects are seen best.
        noise: Whether depth and outlines are as a camera measures them.
        depth_noise: How.
        by: The tracker, as `--tracker` takes it.
        colours: Where colours come from, for a tracker that wants them: "shaded" by rays, the same everywhere; "best":
            OpenGL's where it works. No other has any.
        motion: What is made of its poses.
        grip: When an object is held to be between the fingers, and so to move with the hand.
        first_pictures: Taken before the clock starts, for a better first pose.
        search_s: For so long objects are looked for at first.
        blind_s: Without a picture for so long the camera is off.
        retreat_after_s: An object lost for so long lets the hand retreat upwards; 0 for never.
        retreat_s: For so long, at most; then the plan is followed again, as long as before.
        retreat_m_s: So fast.
    """

    period_s: Positive = 0.04
    latency_s: NonNegative = 0.04
    camera: RgbdCameraCfg = field(default_factory=RgbdCameraCfg)
    eye_m: Place | None = None
    target_m: Place | None = None
    noise: bool = True
    depth_noise: DepthNoiseCfg = field(default_factory=DepthNoiseCfg)
    by: str = "model"
    colours: Literal["shaded", "best"] = "shaded"
    motion: MotionFilterCfg = field(default_factory=MotionFilterCfg)
    grip: GraspDetectionCfg = field(default_factory=GraspDetectionCfg)
    first_pictures: Count = 3
    search_s: NonNegative = 1.0
    blind_s: Positive = 0.5
    retreat_after_s: NonNegative = 1.0
    retreat_s: Positive = 1.0
    retreat_m_s: Positive = 0.15

    def __post_init__(self) -> None:
        if self.latency_s > self.period_s:
            raise InputError("tracked", "latency_s", self.latency_s, f"at most period_s ({self.period_s:g} s)")
        self.choice()

    def choice(self) -> TrackerChoice:
        """The tracker that `by` names.

        Raises:
            InputError: It names none.
        """
        return choose_tracker(self.by, self, "tracked", "by")


def viewpoint(trial: Trial, cfg: TrackedCfg) -> tuple[Place, Place]:
    """Where the camera is, and what it looks at.

    Raises:
        InputError: It would look straight down.
    """
    eye, target = EYES.get(trial.task.name, (EYE, TARGET))
    eye, target = cfg.eye_m or eye, cfg.target_m or target
    if np.allclose(eye[:2], target[:2]):
        raise InputError("tracked", "target_m", target, "a point that is not straight below the camera")
    return eye, target


def make_camera(model: mujoco.MjModel, trial: Trial, cfg: TrackedCfg) -> RayCamera:
    """The camera of an episode, its noise and its colours as configured."""
    noise = DepthNoise(cfg.depth_noise) if cfg.noise else None
    return RayCamera(
        model,
        cfg.camera,
        look_at(*viewpoint(trial, cfg)),
        instance_names(model, trial),
        groups=_DRAWN,
        noise=noise,
        colours=cfg.colours if cfg.choice().wants_colours else "none",
    )
