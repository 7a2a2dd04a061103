"""The advisor's cameras: RGB-D pictures of the scene at each question (section 4), also from above. No OpenGL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np

from coral.advisor.question import Picture
from coral.contact.perception.camera import RayCamera, RgbdFrame, hidden_geoms, instance_names, look_at
from coral.contact.perception.tracked_cfg import TrackedCfg, viewpoint
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import simulation_of
from coral.contact.worlds.robot_world import RobotWorld

Look = Callable[[], RgbdFrame | None]
"""Takes a picture of the present world; None without a camera."""


@dataclass(frozen=True, kw_only=True)
class AdvisorCameraCfg:
    """Pictures for questions; the viewpoint is the tracker's."""

    width: int = 640
    height: int = 480
    """Size in pixels; vision models read 640 by 480 without downscaling."""


def make_advisor_camera(
    world: RobotWorld,
    trial: Trial,
    tracked: TrackedCfg,
    cfg: AdvisorCameraCfg,
    rng: np.random.Generator,
    above: bool = False,
) -> Look:
    """Make the advisor's camera. It is built for the first picture: many episodes take none.

    A world without a simulation has no pictures. `rng` draws the depth noise only, so that taking pictures changes
    nothing else. `above`: the camera stands above the table instead, x up in the picture.
    """
    simulation = simulation_of(world)
    camera: list[RayCamera] = []

    def look() -> RgbdFrame | None:
        if simulation is None:
            return None
        if not camera:
            camera.append(
                RayCamera(
                    simulation.model,
                    replace(tracked.camera, width=cfg.width, height=cfg.height),
                    look_at(*(_above(trial) if above else viewpoint(trial, tracked))),
                    instance_names(simulation.model, trial),
                    noise=tracked.sensor_noise(),
                    colours=True,
                    hidden=hidden_geoms(simulation.model, trial),
                )
            )
        return camera[0].take(simulation.data, rng)

    return look


def _above(trial: Trial) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return where the camera above the table stands and looks: a little from the robot's side, so that x points up."""
    x, y = trial.task.table.center
    return (x - 0.01, y, 1.3 * max(trial.task.table.size[:2])), (x, y, 0.0)


def to_picture(frame: RgbdFrame) -> Picture:
    """Encode the colours of a frame as a picture for a question."""
    assert frame.rgb is not None
    done, data = cv2.imencode(".png", frame.rgb[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 6])
    assert done
    return Picture(name="scene", png=bytes(data), caption="The scene as the robot's camera sees it.")
