"""A camera's automatic exposure and white balance, its sensor's noise, and the curve of sRGB."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from coral.reef.paint.water_kernels import develop
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.world.geometry import Pose

_LUMA = (0.2126, 0.7152, 0.0722)


def expose(light: NDArray[np.float32], cfg: PainterCfg, seed: int) -> NDArray[np.uint8]:
    """Take the picture, RGB in sRGB, of the light that reaches the lens, linear, on any scale. Shape=(H, W, 3) both.

    Exposure and white balance follow from this picture alone, so a picture does not depend on those before it.
    """
    mean = np.maximum(light.reshape(-1, 3).mean(axis=0, dtype=np.float64), 1e-9)
    balance = (mean[1] / mean) ** cfg.white_balance
    gain = cfg.exposure / float(np.dot(_LUMA, mean * balance))
    red, green, blue = (float(gain * b) for b in balance)
    picture = np.empty(light.shape, np.uint8)
    develop(light, (red, green, blue), cfg.vignette, cfg.photons, cfg.read_noise, seed, srgb_table(), picture)
    return picture


def noise_seed(seed: int, pose: Pose, t: float) -> int:
    """Return the seed of one picture's noise: another one for every pose and time."""
    return hash((seed, round(t * 1e6), *(round(v * 1e6) for v in pose))) & 0x7FFFFFFF


@cache
def srgb_table() -> NDArray[np.uint8]:
    """Return the sRGB curve (IEC 61966-2-1) for 4096 linear values from 0 to 1."""
    x = np.linspace(0.0, 1.0, 4096)
    curve = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.round(255.0 * curve).astype(np.uint8)
