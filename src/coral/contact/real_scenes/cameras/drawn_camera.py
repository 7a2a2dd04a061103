"""A camera that draws a trial's scene, noisy as a real one: beside the simulated arm, or to practise with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.cameras.rgbd_camera import bare_frame
from coral.contact.real_scenes.posed_scene import PosedScene, scene_at_start
from coral.contact.scene.observation import Array, Observation
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.errors import InputError

PICTURES, PERIOD_S = 10, 0.1
"""Number of pictures of a still scene, and the time between two."""


class DrawnRgbdCamera:
    """Draws a picture of the newest state. The pictures hold no masks, and nobody else sees the state.

    The hand is drawn, the arm's other links are not.

    `T_world_camera`, Shape=(4, 4), is where the camera is believed to stand, as a calibration says; by default where it
    does stand. `live`: states come by the clock; otherwise the pictures end with them.
    """

    def __init__(
        self,
        trial: Trial,
        cfg: TrackedCfg,
        state: Callable[[], Observation | None],
        T_world_camera: Array | None = None,
        live: bool = True,
    ) -> None:
        self.name, self.live = f"drawn:{trial.task.name}", live
        self._scene = PosedScene(trial, cfg)
        self._believed = self._scene.camera.T_world_camera if T_world_camera is None else T_world_camera
        self._rng = np.random.default_rng([trial.seed, 11])
        self._state, self._drawn_s = state, -1.0

    def start(self) -> None:
        """See `RgbdCamera.start`."""

    def newest(self) -> RgbdFrame | None:
        """See `RgbdCamera.newest`."""
        state = self._state()
        if state is None or state.time_s == self._drawn_s:
            return None
        self._drawn_s = state.time_s
        full = self._scene.take(state, self._rng)
        return bare_frame(full.depth, full.rgb, full.lens, self._believed, full.time_s)

    def close(self) -> None:
        """See `RgbdCamera.close`."""


def still_camera(task: str, T_world_camera: Array | None = None) -> DrawnRgbdCamera:
    """Make a camera that sees a task's scene as it begins, for some pictures.

    Raises:
        InputError: There is no such task.
    """
    if not task:
        raise InputError("--camera", "", "drawn", "drawn:TASK")
    trial = sample_trial(load_task(task), 0)
    start = scene_at_start(trial)
    states = iter([replace(start, time_s=PERIOD_S * k) for k in range(PICTURES)])
    return DrawnRgbdCamera(trial, TrackedCfg(), lambda: next(states, None), T_world_camera, live=False)
