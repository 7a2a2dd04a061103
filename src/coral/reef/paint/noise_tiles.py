"""Seamless noise tiles with their coarser levels: what every procedural surface here is made of."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

SIZE = 512
"""Edge of the finest level (texels)."""
SMOOTH, GRAIN, FLAKES, PEBBLES = range(4)
"""Channels of a tile, 0 to 1: clouds of all sizes; grains of sand; bright angular flakes; the height of pebbles."""


@cache
def noise_tile(seed: int) -> NDArray[np.uint8]:
    """Make a tile that repeats without a seam, and its coarser levels, each half the size of the one before.

    The texels of all levels, row by row, from fine to coarse; 0 to 255 stand for 0 to 1. Shape=((4 SIZE^2 - 1) / 3, 4).
    """
    rng = np.random.default_rng([seed, 0x5EAF])
    channels = [
        _spectral(rng, 1.7),
        _spectral(rng, 0.7),
        _cells(rng, 2600, flakes=True),
        _cells(rng, 1500, flakes=False),
    ]
    level = np.stack(channels, axis=-1).astype(np.float32)
    levels = [level]
    while len(level) > 1:
        level = 0.25 * (level[::2, ::2] + level[1::2, ::2] + level[::2, 1::2] + level[1::2, 1::2])
        levels.append(np.ascontiguousarray(level))
    return np.round(255.0 * np.concatenate([level.reshape(-1, 4) for level in levels])).astype(np.uint8)


def _spectral(rng: np.random.Generator, slope: float) -> NDArray[np.float64]:
    """Return noise whose amplitude falls with the frequency to the power `slope`, spread evenly over 0 to 1."""
    frequency = np.fft.fftfreq(SIZE) * SIZE
    radius = np.hypot(frequency[:, None], frequency[None, :])
    radius[0, 0] = np.inf
    spectrum = np.fft.fft2(rng.standard_normal((SIZE, SIZE))) * radius**-slope
    field = np.fft.ifft2(spectrum).real
    return np.asarray(np.clip(0.5 + 0.2 * field / field.std(), 0.0, 1.0))


def _cells(rng: np.random.Generator, count: int, *, flakes: bool) -> NDArray[np.float64]:
    """Return scattered bits, darkness between them: tilted flakes with sharp edges, or round pebbles."""
    field = np.zeros((SIZE, SIZE))
    reach = 14
    v, u = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    for x, y, angle, size, shape, light in zip(
        rng.uniform(0, SIZE, count),
        rng.uniform(0, SIZE, count),
        rng.uniform(0, 2 * np.pi, count),
        rng.lognormal(1.35, 0.45, count).clip(1.5, 11.0),
        rng.uniform(0.35, 0.9, count),
        rng.uniform(0.45, 1.0, count),
        strict=True,
    ):
        i, j = int(y), int(x)
        du, dv = u + j - x, v + i - y
        a, b = np.cos(angle) * du + np.sin(angle) * dv, (np.cos(angle) * dv - np.sin(angle) * du) / shape
        edge = 1.0 - (np.maximum(np.abs(a), 0.6 * np.abs(a) + 0.8 * np.abs(b)) if flakes else np.hypot(a, b)) / size
        bit = light * (np.clip(3.0 * edge, 0.0, 1.0) if flakes else np.sqrt(np.clip(edge, 0.0, 1.0)))
        rows, columns = (i + v) % SIZE, (j + u) % SIZE
        field[rows, columns] = np.maximum(field[rows, columns], bit)
    return field
