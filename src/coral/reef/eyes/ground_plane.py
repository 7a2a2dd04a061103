"""The sea floor's depth in every pixel, from the camera's height and attitude alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Pose

NEAR_PER_M, FAR_PER_M = 4.0, 0.0
"""Bounds of the inverse depth that networks are given (1/m): 0.25 m and the horizon."""


def ground_depth(
    camera: CameraCfg, height: float | None = None, *, roll: float = 0.0, pitch: float = 0.0
) -> NDArray[np.float32]:
    """Compute the depth (m) at which each pixel's ray meets a flat sea floor, inf above the horizon. Shape=(H, W)."""
    fx, fy, cx, cy = camera.intrinsics
    transform = T_world_camera(Pose(0.0, 0.0, 0.0), camera, altitude=height, roll=roll, pitch=pitch)
    p = (np.arange(camera.width) - cx) / fx
    q = (np.arange(camera.height) - cy) / fy
    falling = -(transform[2, 0] * p[None, :] + transform[2, 1] * q[:, None] + transform[2, 2])
    depth = np.full(falling.shape, np.inf)
    np.divide(transform[2, 3], falling, out=depth, where=falling > 1e-9)
    return depth.astype(np.float32)


def network_input(rgb: NDArray[np.uint8], ground: NDArray[np.float32]) -> NDArray[np.float32]:
    """Stack a picture, -1 to 1, and the inverse of `ground_depth` (1/m), as our networks read them. Shape=(4, H, W)."""
    stacked = np.empty((4, *ground.shape), np.float32)
    stacked[:3] = rgb.transpose(2, 0, 1).astype(np.float32) / 127.5 - 1.0
    stacked[3] = np.clip(1.0 / ground, FAR_PER_M, NEAR_PER_M)
    return stacked
