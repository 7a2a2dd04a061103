"""A sonar's echoes in the camera's picture: points of known depth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.sonar_3d15 import sonar_attitude
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.world.geometry import Pose


def echoes_in_picture(image: RangeImage, pitch_down_deg: float, camera: CameraCfg) -> NDArray[np.float32]:
    """Return `project_points` of the echoes of a sonar at the body's origin, where the camera is too."""
    heard = np.isfinite(image.ranges)
    points = image.directions()[heard] * image.ranges[heard][:, None]
    to_body = sonar_attitude(0.0, 0.0, 0.0, pitch_down_deg)
    to_camera = T_world_camera(Pose(0.0, 0.0, 0.0), camera)[:3, :3].T
    return project_points(points @ (to_camera @ to_body).T, camera)


def project_points(points: NDArray[np.float64], camera: CameraCfg) -> NDArray[np.float32]:
    """Return column, row (px) and depth (m) of the points in the optical frame (m) that are in view. Shape=(M, 3)."""
    x, y, z = points.T
    ahead = z > camera.near_m
    x, y, z = x[ahead], y[ahead], z[ahead]
    fx, fy, cx, cy = camera.intrinsics
    u, v = cx + fx * x / z, cy + fy * y / z
    inside = (u > -0.5) & (u < camera.width - 0.5) & (v > -0.5) & (v < camera.height - 0.5)
    return np.stack([u[inside], v[inside], z[inside]], axis=1).astype(np.float32)
