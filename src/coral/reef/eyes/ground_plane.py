"""Depth in every pixel from the camera's height and attitude alone: of the flat sea floor, and of what stands on it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Label, Pose

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


def standing_depth(labels: NDArray[np.uint8], ground: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the depth of every pixel (m), if what is seen lies on the sea floor or stands upright on it. Shape=(H, W).

    Sea floor and oysters have the depth of the plane, `ground_depth`. An obstacle has in each column the depth of the
    plane at its lowest pixel, its foot; above the horizon without a foot, as a floating ball, it has none. Inf for
    water and where nothing is known.
    """
    depth = np.where((labels == Label.SEABED) | (labels == Label.OYSTER), ground, np.float32(np.inf))
    foot = np.full(labels.shape[1], np.inf, np.float32)
    below = np.zeros(labels.shape[1], np.bool_)
    for row in range(labels.shape[0] - 1, -1, -1):
        hit = labels[row] == Label.OBSTACLE
        foot = np.where(hit & ~below, ground[row], foot)
        depth[row] = np.where(hit, foot, depth[row])
        below = hit
    return depth.astype(np.float32)


def network_input(rgb: NDArray[np.uint8], ground: NDArray[np.float32]) -> NDArray[np.float32]:
    """Stack a picture, -1 to 1, and the inverse of `ground_depth` (1/m), as our networks read them. Shape=(4, H, W)."""
    stacked = np.empty((4, *ground.shape), np.float32)
    stacked[:3] = rgb.transpose(2, 0, 1).astype(np.float32) / 127.5 - 1.0
    stacked[3] = np.clip(1.0 / ground, FAR_PER_M, NEAR_PER_M)
    return stacked
