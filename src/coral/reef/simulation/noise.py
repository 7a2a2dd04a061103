"""Imperfect sensing: noisy depth, lost pixels, turbid water, wrong masks, drifting pose. All off by default."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Fraction, NonNegative, Positive
from coral.errors import InputError
from coral.reef.vehicle.camera import CameraCfg, ray_lengths
from coral.reef.world.geometry import Frame, Label, Pose, wrap


@dataclass(frozen=True, kw_only=True)
class SensorNoiseCfg:
    """Errors of the sensors. The paper's simulation has no noise (III-A), so all are off by default."""

    depth_sigma: NonNegative = 0.0
    """Standard deviation of the depth per metre of depth (m/m)."""
    depth_sigma_square: NonNegative = 0.0
    """Standard deviation of the depth per squared metre of depth (m/m²), as in stereo; added to `depth_sigma`."""
    dropout: Fraction = 0.0
    """Probability that a pixel returns nothing."""
    visibility_m: Positive | None = None
    """Turbidity: nothing is visible beyond this range along the ray (m). None: clear water."""
    visibility_falloff: Fraction = 0.3
    """Last share of that range over which the probability of losing a pixel rises from 0 to 1."""
    oyster_missed: Fraction = 0.0
    """Share of oyster pixels labelled seabed."""
    obstacle_missed: Fraction = 0.0
    """Share of obstacle pixels labelled seabed."""
    oyster_false: Fraction = 0.0
    """Share of seabed pixels labelled oyster."""
    obstacle_false: Fraction = 0.0
    """Share of seabed pixels labelled obstacle."""
    patch_px: Count = 6
    """Edge of the square patches in which masks are wrong: segmentation errs in patches, not in single pixels."""
    drift_xy: NonNegative = 0.0
    """Random walk of the estimated position along each axis (m per square root of a second)."""
    drift_theta: NonNegative = 0.0
    """Random walk of the estimated heading (rad per square root of a second)."""

    def __post_init__(self) -> None:
        if self.oyster_false + self.obstacle_false > 1.0:
            found = self.oyster_false + self.obstacle_false
            raise InputError("noise", "oyster_false + obstacle_false", found, "a sum of at most 1")

    @property
    def wrong_masks(self) -> bool:
        """Whether any label can be wrong."""
        return max(self.oyster_missed, self.obstacle_missed, self.oyster_false, self.obstacle_false) > 0.0


class SensorNoise:
    """Adds noise to camera pictures. With all errors off it returns the same frame and draws no random numbers."""

    def __init__(self, cfg: SensorNoiseCfg, rng: np.random.Generator, camera: CameraCfg | None = None) -> None:
        """Store the settings and the generator."""
        self.cfg = cfg
        self._rng = rng
        self._lengths = ray_lengths(camera or CameraCfg())

    def apply(self, frame: Frame) -> Frame:
        """Return a noisy copy of a frame. Lost pixels become water at infinite depth.

        Masks are corrupted first, then pixels are lost (turbidity by the true range), then depth gets its noise.
        """
        cfg, rng = self.cfg, self._rng
        noisy = cfg.depth_sigma > 0.0 or cfg.depth_sigma_square > 0.0
        if not (noisy or cfg.dropout > 0.0 or cfg.visibility_m is not None or cfg.wrong_masks):
            return frame
        depth, labels, instances = frame.depth.copy(), frame.labels.copy(), frame.instances.copy()
        if cfg.wrong_masks:
            self._spoil_masks(labels, instances)
        lost = np.zeros(depth.shape, np.bool_)
        if cfg.visibility_m is not None:
            clear = (1.0 - cfg.visibility_falloff) * cfg.visibility_m
            soft = max(cfg.visibility_m - clear, 1e-9)
            chance = (frame.depth * self._lengths - clear) / soft
            lost |= rng.random(depth.shape) < chance
        if cfg.dropout > 0.0:
            lost |= rng.random(depth.shape) < cfg.dropout
        if noisy:
            seen = np.isfinite(depth)
            z = np.where(seen, depth, np.float32(0.0))
            sigma = cfg.depth_sigma * z + cfg.depth_sigma_square * z * z
            noise = rng.standard_normal(depth.shape, np.float32) * sigma
            # A surface stays in front of the camera.
            depth = np.where(seen, np.maximum(z + noise, np.float32(1e-3)), depth).astype(np.float32)
        depth[lost] = np.inf
        labels[lost] = Label.WATER
        instances[lost] = -1
        return Frame(depth, labels, instances, frame.rgb)

    def _spoil_masks(self, labels: NDArray[np.uint8], instances: NDArray[np.int32]) -> None:
        """Corrupt masks by patch: one number in [0, 1) each, at a random offset. A class is wrong below its share."""
        cfg, n = self.cfg, self.cfg.patch_px
        height, width = labels.shape
        top, side = self._rng.integers(0, n, 2)
        coarse = self._rng.random((height // n + 2, width // n + 2))
        patch = coarse.repeat(n, axis=0).repeat(n, axis=1)[top : top + height, side : side + width]
        seabed = labels == Label.SEABED
        missed = ((labels == Label.OYSTER) & (patch < cfg.oyster_missed)) | (
            (labels == Label.OBSTACLE) & (patch < cfg.obstacle_missed)
        )
        oyster = seabed & (patch < cfg.oyster_false)
        obstacle = seabed & ~oyster & (patch < cfg.oyster_false + cfg.obstacle_false)
        labels[missed] = Label.SEABED
        labels[oyster] = Label.OYSTER
        labels[obstacle] = Label.OBSTACLE
        instances[missed] = -1


class PoseDrift:
    """Dead reckoning. The estimated pose is the true pose plus a random walk."""

    def __init__(self, cfg: SensorNoiseCfg, rng: np.random.Generator) -> None:
        self.cfg = cfg
        self.error = (0.0, 0.0, 0.0)
        """Estimated minus true: x (m), y (m), theta (rad)."""
        self._rng = rng

    def step(self, true_pose: Pose, dt: float) -> Pose:
        """Return the estimate after `dt` seconds. Without drift it is the true pose, and nothing is drawn."""
        cfg = self.cfg
        if cfg.drift_xy == 0.0 and cfg.drift_theta == 0.0:
            return true_pose
        draws = self._rng.standard_normal(3) * math.sqrt(dt)
        x, y, theta = self.error
        self.error = (
            x + cfg.drift_xy * float(draws[0]),
            y + cfg.drift_xy * float(draws[1]),
            theta + cfg.drift_theta * float(draws[2]),
        )
        return Pose(true_pose.x + self.error[0], true_pose.y + self.error[1], wrap(true_pose.theta + self.error[2]))
