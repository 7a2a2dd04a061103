"""Noise of a real depth camera: axial noise, uneven depth, jagged and wavy outlines, disparity steps, holes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import Fraction, NonNegative
from coral.contact.perception.noise_kernels import disturb
from coral.contact.scene.observation import Array


@dataclass(frozen=True, kw_only=True)
class DepthNoiseCfg:
    """A short-range structured-light or stereo camera, and masks from a segmentation network.

    Axial and lateral noise: Nguyen, Izadi, Lovell, "Modeling Kinect sensor noise for improved 3D reconstruction and
    tracking" (3DIMPVT 2012), Eqs. 1-3; they hold for 640 columns.
    """

    axial_m: NonNegative = 0.0012
    """Standard deviation at 0.4 m, at normal incidence."""
    axial_growth: NonNegative = 0.0019
    """Its growth with (z - 0.4 m)^2, per metre."""
    uneven_m: NonNegative = 0.001
    """Standard deviation at 1 m of an error shared by neighbouring pixels, so that averaging does not remove it."""
    lateral_px: NonNegative = 0.8
    """Standard deviation of an outline's position, in pixels of a picture 640 columns wide."""
    wavy_px: NonNegative = 0.8
    """Standard deviation of its part that neighbouring pixels share: masks bulge and recede."""
    disparity_step_px: NonNegative = 0.0625
    """Depth is quantised in disparity, usually to a sixteenth of a pixel by stereo matchers; 0 for no quantisation."""
    baseline_m: NonNegative = 0.05
    """Distance between the two lenses; with 0.05 m the steps at 1 m are 2 mm."""
    grazing_deg: NonNegative = 82.0
    """Surfaces whose normal is farther than this from the ray return nothing: the paper's formula diverges there."""
    edge_hole: Fraction = 0.3
    """Share of pixels at depth jumps that return nothing."""
    hole: Fraction = 0.002
    """Share of all other pixels that return nothing."""
    jump_m: NonNegative = 0.03
    """Depth difference between neighbours that counts as a jump."""

    def apply(
        self, depth: Array, normal: Array, instance: NDArray[np.uint8], lens: Array, rng: np.random.Generator
    ) -> tuple[Array, NDArray[np.uint8]]:
        """Add noise to depth and instances, Shape=(H, W); depth is in metres, inf without a surface or measurement.

        The unit normals, Shape=(H, W, 3), are in the camera frame, the lens is fx, fy, cx, cy in pixels.
        """
        height, width = depth.shape
        scale = width / 640.0
        steps = lens[0] / scale * self.baseline_m / self.disparity_step_px if self.disparity_step_px > 0.0 else 0.0
        amounts = np.array(
            [
                self.lateral_px * scale,
                self.wavy_px * scale,
                self.axial_m,
                self.axial_growth,
                self.uneven_m,
                steps,
                math.cos(math.radians(self.grazing_deg)),
                self.edge_hole,
                self.hole,
                self.jump_m,
            ]
        )
        wavy = np.stack([_smooth(height, width, rng) for _ in range(2)])
        lateral, axial = _normal((2, height, width), rng), _normal((height, width), rng)
        uneven, chance = _smooth(height, width, rng), rng.random((height, width), np.float32)
        measured, labels = np.empty((height, width)), np.empty((height, width), np.uint8)
        disturb(depth, normal, instance, lens, lateral, wavy, axial, uneven, chance, amounts, measured, labels)
        return measured, labels


D435 = DepthNoiseCfg(
    axial_m=0.0006,
    axial_growth=0.0089,
    uneven_m=0.002,
    lateral_px=1.5,
    wavy_px=1.5,
    disparity_step_px=1 / 32,
    edge_hole=0.5,
    hole=0.01,
)
"""A stereo camera as Intel's D435 at 848 x 480: a disparity that errs by 0.08 pixels, with a focal length of 424 pixels
(90 degrees) and a baseline of 50 mm, gives 0.6 mm at 0.4 m and 3.8 mm at 1 m (z^2 times 0.08 / 21.2 m). Its steps of
1/32 pixel are Intel's; the error of the disparity, what neighbours share of it, wide edges and holes are assumed."""
SENSORS: Mapping[str, DepthNoiseCfg] = {"kinect": DepthNoiseCfg(), "d435": D435}
Sensor = Literal["kinect", "d435"]


def _normal(shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.float32]:
    """Draw independent standard normal noise; single precision takes half the time."""
    return rng.standard_normal(shape, np.float32)


def _smooth(height: int, width: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """Draw standard normal noise, correlated over a sixteenth of the picture's width. Shape=(H, W)."""
    coarse = rng.standard_normal((max(2, round(16 * height / width)), 16), np.float32)
    return np.asarray(cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC), np.float32)
