"""Configuration of tracking: camera and viewpoint, tracker, and use of its poses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np

from coral.config import Count, NonNegative, Positive, Signed
from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, instance_names, look_at
from coral.contact.perception.depth_noise import SENSORS, DepthNoiseCfg, Sensor
from coral.contact.perception.tracker_registry import TrackerChoice, choose_tracker
from coral.contact.scene.trial import Trial
from coral.errors import InputError

Place = tuple[Signed, Signed, Signed]
EYE, TARGET = (0.05, -0.9, 0.35), (0.05, 0.0, 0.08)
"""From the robot's right across the table, low: the arm comes from behind and above, and occludes least there."""
EYES: Mapping[str, tuple[Place, Place]] = {
    "push-pick-board": ((-0.35, 0.75, 0.6), (0.05, 0.0, 0.05)),  # the hand takes the board's right-hand side
    "LIBERO-OBJECT": ((0.9966, 0.0, 0.65), (-0.05, 0.0, 0.0)),  # LIBERO's own "agentview", in our frame
}
"""Viewpoints of tasks, by name or title, that are better observed from elsewhere."""
_DRAWN = (0,)
"""Geom groups: the robot is drawn by its collision shapes, a little thicker than its visual ones and twice as fast."""


@dataclass(frozen=True, kw_only=True)
class TrackedCfg:
    """The camera, the tracker, and the use of its poses."""

    period_s: Positive = 0.04
    """Time between two pictures."""
    latency_s: NonNegative = 0.04
    """Time from a picture to its poses; at most `period_s`, as one picture is processed at a time."""
    camera: RgbdCameraCfg = field(default_factory=RgbdCameraCfg)
    """Size, field of view and range."""
    eye_m: Place | None = None
    target_m: Place | None = None
    """Position of the camera and the point that it looks at; by default the best for the task."""
    noise: bool = True
    """Whether depth and outlines are noisy, like a real camera's."""
    sensor: Sensor = "kinect"
    """Whose noise it is: a short-range structured-light camera's, or that of a stereo camera as the D435."""
    by: str = "model"
    """The tracker, as `--tracker` takes it."""
    first_pictures: Count = 3
    """Number of pictures before the clock starts, for a better first pose."""
    search_s: NonNegative = 1.0
    """Longest search for the objects at the start."""
    blind_s: Positive = 0.5
    """Time without a picture after which the camera counts as off."""
    retreat_after_s: NonNegative = 1.0
    """Time after which the hand retreats upwards if an object stays lost; 0 for never."""
    retreat_s: Positive = 1.0
    """Longest retreat; after it the plan is followed for `retreat_after_s` again."""
    retreat_m_s: Positive = 0.15
    """Speed of the retreat."""

    def __post_init__(self) -> None:
        if self.latency_s > self.period_s:
            raise InputError("tracked", "latency_s", self.latency_s, f"at most period_s ({self.period_s:g} s)")
        self.choice()

    def sensor_noise(self) -> DepthNoiseCfg | None:
        """Return the noise of the pictures; None without."""
        return SENSORS[self.sensor] if self.noise else None

    def choice(self) -> TrackerChoice:
        """Return the tracker that `by` names.

        Raises:
            InputError: There is no such tracker.
        """
        return choose_tracker(self.by, "tracked", "by")


def viewpoint(trial: Trial, cfg: TrackedCfg) -> tuple[Place, Place]:
    """Choose the position of the camera and the point that it looks at.

    Raises:
        InputError: The camera would look straight down.
    """
    eye, target = EYES.get(trial.task.name) or EYES.get(trial.task.title, (EYE, TARGET))
    eye, target = cfg.eye_m or eye, cfg.target_m or target
    if np.allclose(eye[:2], target[:2]):
        raise InputError("tracked", "target_m", target, "a point that is not straight below the camera")
    return eye, target


def make_camera(model: mujoco.MjModel, trial: Trial, cfg: TrackedCfg, colours: bool = False) -> RayCamera:
    """Make an episode's camera, with noise as configured; it has colours if asked for, or if the tracker needs them."""
    return RayCamera(
        model,
        cfg.camera,
        look_at(*viewpoint(trial, cfg)),
        instance_names(model, trial),
        groups=_DRAWN,
        noise=cfg.sensor_noise(),
        colours=colours or cfg.choice().wants_colours,
    )
