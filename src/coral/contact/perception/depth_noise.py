"""What a real depth camera adds: axial noise, jagged outlines, disparity steps and holes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class DepthNoiseCfg:
    """A short-range structured-light or stereo camera.

    Axial and lateral noise: Nguyen, Izadi, Lovell, "Modeling Kinect sensor noise for improved 3D reconstruction and
    tracking" (3DIMPVT 2012), Eqs. 1-3; they hold for 640 columns.
    """

    axial_m: float = 0.0012
    """Standard deviation at 0.4 m, straight on."""
    axial_growth: float = 0.0019
    """Its growth with (z - 0.4 m)^2, per metre."""
    lateral_px: float = 0.8
    """Standard deviation of where an outline is seen, in pixels of a picture 640 columns wide."""
    disparity_step_px: float = 0.0625
    """Depth comes in steps of disparity: a sixteenth of a pixel, usual for stereo matchers; 0 for none."""
    baseline_m: float = 0.05
    """Between the two eyes; with 0.05 m the steps at 1 m are 2.3 mm at 640 columns."""
    grazing_deg: float = 82.0
    """Surfaces seen at a steeper slant from their normal return nothing: beyond it the paper's formula diverges."""
    edge_hole: float = 0.3
    """Share of pixels at jumps of depth that return nothing."""
    hole: float = 0.002
    """Share of all other pixels that return nothing."""
    jump_m: float = 0.03
    """What counts as a jump of depth between neighbours."""


class DepthNoise:
    """Makes a perfect picture a measured one."""

    def __init__(self, cfg: DepthNoiseCfg | None = None) -> None:
        self.cfg = cfg or DepthNoiseCfg()

    def apply(
        self, depth: Array, normal: Array, instance: NDArray[np.uint8], lens: Array, rng: np.random.Generator,
    ) -> tuple[Array, NDArray[np.uint8]]:
        """Depth (m, inf where nothing is measured) and instances with noise.

        Args:
            depth: Shape=(H, W) m, inf where nothing is seen.
            normal: Shape=(H, W, 3), unit normals in the camera frame.
            instance: Shape=(H, W).
            lens: Shape=(4,): fx, fy, cx, cy in pixels.
            rng: Where the noise comes from.
        """
        cfg = self.cfg
        height, width = depth.shape
        spread = cfg.lateral_px * width / 640.0
        shift = np.rint(rng.normal(0.0, spread, (2, height, width))).astype(np.int64)
        rows = (np.arange(height)[:, None] + shift[0]).clip(0, height - 1)
        columns = (np.arange(width)[None, :] + shift[1]).clip(0, width - 1)
        p, q = (np.arange(width) - lens[2]) / lens[0], (np.arange(height) - lens[3]) / lens[1]
        facing = -(normal[..., 0] * p[None, :] + normal[..., 1] * q[:, None] + normal[..., 2])
        facing /= np.sqrt(1.0 + p[None, :] ** 2 + q[:, None] ** 2)
        hole = facing < math.cos(math.radians(cfg.grazing_deg))
        tilt = np.arccos(facing.clip(0.0, 1.0)).clip(0.0, 1.5)
        # A shifted pixel that stays on the same surface keeps its own depth: only outlines are jagged.
        seen = np.where(np.isfinite(depth), depth, 99.0)
        moved = seen[rows, columns]
        jump = np.abs(moved - seen) > cfg.jump_m
        z = np.where(jump, moved, seen)
        axial = cfg.axial_m + cfg.axial_growth * (z - 0.4) ** 2 + 1e-4 / np.sqrt(z) * (tilt / (math.pi / 2 - tilt)) ** 2
        noisy = z + axial.clip(0.0, 0.05) * rng.standard_normal((height, width))
        if cfg.disparity_step_px > 0.0:
            scale = lens[0] * 640.0 / width * cfg.baseline_m / cfg.disparity_step_px
            noisy = scale / np.rint(scale / noisy.clip(0.05)).clip(1.0)
        edge = np.zeros((height, width), bool)
        edge[:, 1:] |= np.abs(np.diff(seen, axis=1)) > cfg.jump_m
        edge[1:] |= np.abs(np.diff(seen, axis=0)) > cfg.jump_m
        hole |= rng.random((height, width)) < np.where(edge | jump, cfg.edge_hole, cfg.hole)
        return np.where(hole | (z > 98.0), np.inf, noisy), instance[rows, columns]
