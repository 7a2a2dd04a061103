"""A simulated Water Linked Sonar 3D-15, which casts its beams against the camera's scene; its echoes in the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Fraction, NonNegative, Positive, Signed
from coral.reef.map import cast_kernels
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.vehicle.range_image import RangeImage, beam_angles, beam_directions
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene, rotations

SEABED, NOTHING, SURFACE = -1, -2, -3
"""What a beam meets besides solids."""
_PATCH = 4, 8
"""Rows and columns of the patches in which an echo comes by a detour."""


@dataclass(frozen=True, kw_only=True)
class SonarCfg:
    """The sonar and its errors.

    Geometry and rate are those of the maker's integration page ("Image Sizes and Update Rates", navigation mode).
    The maker publishes no figures for the errors there: these are ours, and can all be set to 0.
    """

    enabled: bool = False
    """Whether the vehicle has the sonar: `--sonar`."""
    width: Annotated[int, Field(ge=2, le=1024)] = 256
    height: Annotated[int, Field(ge=2, le=1024)] = 64
    hfov_deg: Annotated[float, Field(gt=0, le=180)] = 90.0
    vfov_deg: Annotated[float, Field(gt=0, le=90)] = 40.0
    rate_hz: Positive = 5.0
    """Images per second: 5 Hz for 90 by 40 degrees, 20 Hz for 40 by 40."""
    range_m: Positive = 15.0
    """Longest range, as its name says."""
    nearest_m: NonNegative = 0.3
    """Echoes from nearer than this are lost: the transducers still ring. No published figure."""
    pitch_down_deg: Signed = 15.0
    """Tilt of the mounting, that of the camera: from 1 m above the sea floor the lowest beams meet it 1.4 m ahead."""
    resolution_m: NonNegative = 0.01
    """Step of the ranges in an image."""
    sigma_m: NonNegative = 0.01
    """Standard deviation of a range (m)."""
    sigma_share: NonNegative = 0.003
    """Standard deviation of a range per metre of range, added to `sigma_m`."""
    dropout: Fraction = 0.05
    """Probability that a beam returns nothing."""
    grazing_deg: Annotated[float, Field(ge=0, le=90)] = 8.0
    """Below this angle to the sea floor or the surface an echo gets lost, the flatter the likelier: most of the sound
    is reflected away."""
    multipath: Fraction = 0.01
    """Share of the image whose strongest echo came by a detour, in patches of 8 by 4 beams: it then seems farther."""
    detour_m: NonNegative = 2.0
    """Longest such detour (m)."""


class Sonar3d15:
    """Takes range images of a scene."""

    def __init__(
        self, scene: Scene, cfg: SonarCfg, rng: np.random.Generator, *, surface_z: float | None = None
    ) -> None:
        """Set up; `surface_z` is the height of the water's surface in the world (m), None if it is out of reach."""
        self.scene, self.cfg, self._rng = scene, cfg, rng
        self._surface_z = math.inf if surface_z is None else surface_z
        shape = (cfg.height, cfg.width)
        self._azimuth, self._elevation = beam_angles(shape, cfg.hfov_deg, cfg.vfov_deg)
        self._beams = beam_directions(shape, cfg.hfov_deg, cfg.vfov_deg)
        self.hit: NDArray[np.int32] = np.full(shape, NOTHING, np.int32)
        """What each beam of the last image met: an index into the scene, or SEABED, NOTHING or SURFACE. For tests only.
        Shape=(H, W)."""

    def image(self, pose: Pose, altitude_m: float, *, roll: float = 0.0, pitch: float = 0.0) -> RangeImage:
        """Take an image from a body at `pose` and an altitude above the sea floor; positive pitch lowers the nose."""
        cfg, scene = self.cfg, self.scene
        turn = sonar_attitude(pose.theta, roll, pitch, cfg.pitch_down_deg)
        ranges = np.empty((cfg.height, cfg.width))
        cast_kernels.cast(
            np.array([pose.x, pose.y, scene.seabed_z + altitude_m]),
            turn,
            self._beams,
            self._azimuth,
            self._elevation,
            scene.seabed_z,
            self._surface_z,
            scene.solids,
            cfg.range_m,
            ranges,
            self.hit,
        )
        return RangeImage(self._measured(ranges, np.abs(self._beams @ turn[2])), cfg.hfov_deg, cfg.vfov_deg)

    def _measured(self, ranges: NDArray[np.float64], steepness: NDArray[np.float64]) -> NDArray[np.float32]:
        """Add the errors to exact ranges; `steepness` is the sine of each beam's angle to the horizontal."""
        cfg, rng, shape = self.cfg, self._rng, ranges.shape
        found = ranges.copy()
        lost = ~np.isfinite(found) | (found < cfg.nearest_m)
        if cfg.grazing_deg > 0.0:
            flat = (self.hit == SEABED) | (self.hit == SURFACE)
            weak = 1.0 - steepness / math.sin(math.radians(cfg.grazing_deg))
            lost |= flat & (rng.random(shape) < weak)
        if cfg.dropout > 0.0:
            lost |= rng.random(shape) < cfg.dropout
        found[lost] = np.inf
        if cfg.multipath > 0.0:
            rows, columns = (-(-size // edge) for size, edge in zip(shape, _PATCH, strict=True))
            detour = np.where(
                rng.random((rows, columns)) < cfg.multipath, rng.uniform(0.0, cfg.detour_m, (rows, columns)), 0.0
            )
            found += detour.repeat(_PATCH[0], axis=0).repeat(_PATCH[1], axis=1)[: shape[0], : shape[1]]
        if cfg.sigma_m > 0.0 or cfg.sigma_share > 0.0:
            sigma = cfg.sigma_m + cfg.sigma_share * np.where(np.isfinite(found), found, 0.0)
            found += sigma * rng.standard_normal(shape)
        if cfg.resolution_m > 0.0:
            found = np.round(found / cfg.resolution_m) * cfg.resolution_m
        found[found > cfg.range_m] = np.inf
        return np.where(np.isfinite(found), np.maximum(found, cfg.nearest_m + 1e-3), np.inf).astype(np.float32)


def sonar_attitude(theta: float, roll: float, pitch: float, pitch_down_deg: float) -> NDArray[np.float64]:
    """Return the rotation from the sonar's frame (x forward, y left, z up) to the world. Shape=(3, 3).

    Heading, roll and pitch (rad) are the body's; a positive pitch lowers the nose, as the mount is tilted (degrees).
    """
    body, mount = rotations([(roll, pitch, theta), (0.0, math.radians(pitch_down_deg), 0.0)])
    return np.ascontiguousarray(body @ mount)


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
