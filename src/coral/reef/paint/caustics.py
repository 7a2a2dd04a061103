"""Light that waves focus on the sea floor, as a film that repeats in space and time."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

TILE_M = 2.4
"""Edge of the tile (m)."""
PERIOD_S = 6.0
"""Duration of the film."""
SIZE, FRAMES = 128, 48
GRAVITY_M_S2, INDEX = 9.81, 1.34


@cache
def caustics(seed: int, depth_m: float, slope: float) -> NDArray[np.float32]:
    """Refract the sun's rays at moving waves and collect them on the floor. Shape=(FRAMES, SIZE, SIZE).

    A ray that meets the surface where its slope is s is bent by (1 - 1/n) s, so it lands that much times the depth
    away (Snell's law for small angles). Waves of deep water obey omega^2 = g k; their frequencies are rounded so that
    the film repeats. `slope` is the root mean square slope of the waves. Light is relative to its mean.
    """
    rng = np.random.default_rng([seed, 0xCA5])
    most = 9
    i, j = (n.ravel() for n in np.mgrid[-most : most + 1, -most : most + 1])
    number = 2 * np.pi / TILE_M * np.hypot(i, j)
    kept = (number > 0) & (np.hypot(i, j) <= most)
    i, j, number = i[kept], j[kept], number[kept]
    turns = np.maximum(np.round(np.sqrt(GRAVITY_M_S2 * number) * PERIOD_S / (2 * np.pi)), 1.0)
    height = rng.normal(size=len(i)) * number**-2.0 * np.exp(-((number / 14.0) ** 2))
    height *= slope / np.sqrt(0.5 * np.sum((height * number) ** 2))
    phase = rng.uniform(0, 2 * np.pi, len(i))
    throw = depth_m * (1.0 - 1.0 / INDEX)
    fine = 2 * SIZE
    at = np.arange(fine) / fine
    column, row = np.meshgrid(at, at)
    film = np.empty((FRAMES, SIZE, SIZE), np.float32)
    for frame in range(FRAMES):
        spectrum = np.zeros((2, fine, fine), np.complex128)
        wave = height * np.exp(1j * (phase - 2 * np.pi * turns * frame / FRAMES))
        for axis, wave_number in enumerate((i, j)):
            np.add.at(spectrum[axis], (j % fine, i % fine), 1j * wave * 2 * np.pi / TILE_M * wave_number)
        bend = np.fft.ifft2(spectrum).real * fine * fine * throw / TILE_M
        x, y = (column - bend[0]) * SIZE, (row - bend[1]) * SIZE
        u, v = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
        a, b = x - u, y - v
        light = np.zeros(SIZE * SIZE)
        for du, wu in ((0, 1.0 - a), (1, a)):
            for dv, wv in ((0, 1.0 - b), (1, b)):
                light += np.bincount(
                    (((v + dv) % SIZE) * SIZE + (u + du) % SIZE).ravel(), (wu * wv).ravel(), SIZE * SIZE
                )
        film[frame] = light.reshape(SIZE, SIZE) / light.mean()
    return film
