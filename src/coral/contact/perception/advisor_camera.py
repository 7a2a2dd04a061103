"""What a fixed camera shows an advisor: an RGB-D picture of the scene, when it is asked (section 4). No OpenGL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from coral.advisor.question import Picture
from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, RgbdFrame, look_at
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.perception.scene_geoms import hidden_geoms, instance_names
from coral.contact.perception.tracked_cfg import TrackedCfg, viewpoint
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import EvaluationWorld

Look = Callable[[], RgbdFrame | None]
"""A picture of the world as it stands; None where there is no camera."""


@dataclass(frozen=True, kw_only=True)
class AdvisorCameraCfg:
    """The pictures that go with questions; the camera stands where the tracker's does.

    Args:
        width, height: Pixels; 640 by 480 is what vision models see without scaling it down.
    """

    width: int = 640
    height: int = 480


def make_advisor_camera(
    world: EvaluationWorld, trial: Trial, tracked: TrackedCfg, cfg: AdvisorCameraCfg, rng: np.random.Generator
) -> Look:
    """The advisor's camera. It is made with the first picture: many episodes take none.

    Args:
        world: A world that is simulated by MuJoCo has pictures, another has none.
        trial: The trial.
        tracked: Where the camera stands, and how its depth is measured.
        cfg: Its pictures.
        rng: Of the depth's noise; its own, so that looking changes nothing else.
    """
    simulation = world.simulation
    camera: list[RayCamera] = []

    def look() -> RgbdFrame | None:
        if simulation is None:
            return None
        if not camera:
            lens = RgbdCameraCfg(
                width=cfg.width,
                height=cfg.height,
                vfov_deg=tracked.camera.vfov_deg,
                near_m=tracked.camera.near_m,
                far_m=tracked.camera.far_m,
            )
            noise = DepthNoise(tracked.depth_noise) if tracked.noise else None
            camera.append(
                RayCamera(
                    simulation.model,
                    lens,
                    look_at(*viewpoint(trial, tracked)),
                    instance_names(simulation.model, trial),
                    noise=noise,
                    colours="shaded",
                    hidden=hidden_geoms(simulation.model, trial),
                )
            )
        return camera[0].take(simulation.data, rng)

    return look


def to_picture(frame: RgbdFrame) -> Picture:
    """The colours of a frame as they go with a question."""
    assert frame.rgb is not None
    done, data = cv2.imencode(".png", frame.rgb[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 6])
    assert done
    return Picture(name="scene", png=bytes(data), caption="The scene as the robot's camera sees it.")
