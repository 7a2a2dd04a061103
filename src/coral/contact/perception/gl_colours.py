"""Colours of a picture from MuJoCo's own renderer, if OpenGL works (MUJOCO_GL=egl or osmesa without a screen)."""

from __future__ import annotations

import atexit
import math
import warnings
from collections.abc import Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class GlColours:
    """Renders one model from any camera pose.

    Args:
        model: The scene; its offscreen buffer is enlarged as needed.
        width, height: Size of the pictures.
        groups: Geom groups to draw.
    """

    def __init__(self, model: mujoco.MjModel, width: int, height: int, groups: Iterable[int]) -> None:
        model.vis.global_.offwidth = max(width, model.vis.global_.offwidth)
        model.vis.global_.offheight = max(height, model.vis.global_.offheight)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # glfw warns of a missing screen before it fails
            self._renderer = mujoco.Renderer(model, height, width)
        atexit.register(self._renderer.close)  # while the OpenGL library is still there
        self._aspect = width / height
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[list(groups)] = 1
        self._option.sitegroup[:] = 0

    def take(self, data: mujoco.MjData, T_world_camera: Array, vfov_deg: float) -> NDArray[np.uint8]:
        """Render an RGB picture, Shape=(H, W, 3)."""
        self._renderer.update_scene(data, camera=-1, scene_option=self._option)
        half = math.tan(math.radians(vfov_deg) / 2)
        for camera in self._renderer.scene.camera:
            camera.pos, camera.forward, camera.up = T_world_camera[:3, 3], T_world_camera[:3, 2], -T_world_camera[:3, 1]
            near = camera.frustum_near
            camera.frustum_bottom, camera.frustum_top = -near * half, near * half
            camera.frustum_center, camera.frustum_width = 0.0, near * half * self._aspect
        return np.asarray(self._renderer.render(), np.uint8)
