"""A trial's scene with objects and hand at given poses, drawn by a camera."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.control.hand_model import HandCfg, add_hand
from coral.contact.control.planning_world import put_state
from coral.contact.perception.camera import Colours, RayCamera, RgbdCameraCfg, RgbdFrame, look_at
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.perception.scene_geoms import instance_names
from coral.contact.real_scenes.benchmark_motions import MotionSample
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.observation import Observation
from coral.contact.scene.rigid_transform import matrix_to_body
from coral.contact.scene.trial import Trial

Array = NDArray[np.float64]
MOTIONS_EYE, MOTIONS_TARGET = (-0.35, -0.75, 0.6), (0.05, 0.0, 0.05)
"""Viewpoint for prescribed motions: beside the robot, looking down across the table. Episodes use `tracked_cfg.EYE`,
where the arm occludes less."""


class PosedScene:
    """A scene whose poses are set, not simulated.

    Args:
        trial: The trial.
        cfg: The camera.
        noise: Noise of the depth; None for none.
        T_world_camera: Shape=(4, 4); `MOTIONS_EYE` looking at `MOTIONS_TARGET` by default.
        colours: As in `RayCamera`.
    """

    def __init__(
        self,
        trial: Trial,
        cfg: RgbdCameraCfg,
        noise: DepthNoise | None,
        T_world_camera: Array | None = None,
        colours: Colours = "none",
    ) -> None:
        self._trial = trial
        spec = mujoco.MjSpec()
        add_scene(spec, trial)
        add_hand(spec, HandCfg())
        self.model = spec.compile()
        self._data = mujoco.MjData(self.model)
        placed = look_at(MOTIONS_EYE, MOTIONS_TARGET) if T_world_camera is None else T_world_camera
        self.camera = RayCamera(
            self.model, cfg, placed, instance_names(self.model, trial), noise=noise, colours=colours
        )

    def take(self, moment: MotionSample, rng: np.random.Generator, time_s: float = 0.0) -> RgbdFrame:
        """Take a picture of one moment of a motion."""
        objects = {name: matrix_to_body(T) for name, T in moment.objects.items()}
        now = Observation(time_s, matrix_to_body(moment.tool), moment.opening_m, np.zeros(6), objects)
        put_state(self.model, self._data, now, self._trial)
        self._data.time = time_s
        mujoco.mj_kinematics(self.model, self._data)
        return self.camera.take(self._data, rng)
