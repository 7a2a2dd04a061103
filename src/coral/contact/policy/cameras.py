"""The cameras of a policy: LIBERO's two, one across the table and one at the wrist, by ray casting."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.contact.episode.policy_cfg import PolicyCamerasCfg
from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, look_at
from coral.contact.perception.scene_geoms import covered_geoms
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.observation import Array, BodyState
from coral.errors import InputError

Image = NDArray[np.uint8]


class PolicyCameras:
    """Takes both pictures of a simulated world, whose model is not changed.

    Raises:
        InputError: The camera looks straight down, or the scene cannot be drawn.
    """

    def __init__(self, model: mujoco.MjModel, cfg: PolicyCamerasCfg) -> None:
        if np.allclose(cfg.eye_m[:2], cfg.target_m[:2]):
            raise InputError("policy.eyes", "target_m", cfg.target_m, "a point that is not straight below the camera")
        self._cfg = cfg
        hidden = covered_geoms(model)

        def camera(vfov_deg: float, near_m: float, pose: Array) -> RayCamera:
            lens = RgbdCameraCfg(width=cfg.pixels, height=cfg.pixels, vfov_deg=vfov_deg, near_m=near_m)
            return RayCamera(model, lens, pose, {}, colours=True, hidden=hidden)

        self._outside = camera(cfg.vfov_deg, 0.05, look_at(cfg.eye_m, cfg.target_m))
        self._wrist = camera(cfg.wrist_vfov_deg, 0.005, np.eye(4))

    def look(self, data: mujoco.MjData, tool: BodyState) -> tuple[Image, Image]:
        """Take the pictures from across the table and from the wrist, each Shape=(H, W, 3), RGB.

        The state's kinematics are up to date.
        """
        self._wrist.T_world_camera = wrist_pose(tool, np.asarray(self._cfg.wrist_m))
        return self._take(self._outside, data), self._take(self._wrist, data)

    def _take(self, camera: RayCamera, data: mujoco.MjData) -> Image:
        picture = camera.take(data).rgb
        assert picture is not None
        return np.ascontiguousarray(picture[:, ::-1] if self._cfg.mirrored else picture)


def wrist_pose(tool: BodyState, place_m: Array) -> Array:
    """Return T_world_camera, Shape=(4, 4), of a wrist's camera (x right, y down, z forward) at a place of the tool."""
    turn, pose = rotation_of(tool.quaternion), np.eye(4)
    pose[:3, :3] = turn @ np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    pose[:3, 3] = tool.position + turn @ place_m
    return pose
