"""What is prepared of a scene before it is painted: the materials of its solids, the sea floor around them, noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from coral.reef.paint.ground_kernels import rasterise_ground
from coral.reef.paint.surface_kernels import BLOCK, BUOY, CARD, PILE, ROCK, SHELL, TILE_PX
from coral.reef.world.geometry import Label
from coral.reef.world.kinds import catalogue
from coral.reef.world.scene import BOX, CYLINDER, Scene

_SHELLS = np.array([(0.40, 0.38, 0.33), (0.33, 0.29, 0.22), (0.26, 0.25, 0.21), (0.30, 0.26, 0.25), (0.36, 0.36, 0.28)])
"""Chalk, tan, gray, purple brown, olive: outer shells of Crassostrea."""
_ROCKS = np.array([(0.23, 0.21, 0.19), (0.19, 0.19, 0.19), (0.27, 0.23, 0.17)])
_BUOYS = np.array([(0.62, 0.17, 0.03), (0.62, 0.46, 0.05), (0.60, 0.60, 0.58), (0.50, 0.05, 0.04)])
_PILE, _BLOCK = (0.17, 0.12, 0.08), (0.36, 0.35, 0.32)
_MARGIN_M, _CELL_M, _MOST_CELLS = 3.0, 0.03, 2_000_000
SMOOTH, GRAIN, FLAKES, PEBBLES = range(4)
"""Channels of a tile, 0 to 1: clouds of all sizes; grains of sand; bright angular flakes; the height of pebbles."""


@dataclass(frozen=True)
class Materials:
    """Material and reflectance of N solids."""

    kind: NDArray[np.uint8]
    """A constant of `surface_kernels`. Shape=(N,)."""
    paint: NDArray[np.float64]
    """Diffuse reflectance in red, green and blue, 0 to 1, linear. Shape=(N, 3)."""
    fate: NDArray[np.float64]
    """Random numbers that make each one different, 0 to 1. Shape=(N, 4)."""

    @classmethod
    def of(cls, scene: Scene, seed: int) -> Materials:
        """Choose materials: oysters are shells; round obstacles floating balls, ellipsoids rocks, cylinders piles."""
        rng = np.random.default_rng([seed, 0xA7])
        count = len(scene)
        fate = rng.random((count, 4))
        shell = scene.label == Label.OYSTER
        ball = ~shell & (scene.kind != BOX) & (scene.kind != CYLINDER) & (np.ptp(scene.half, axis=1) == 0.0)
        kind = np.select(
            [shell, ball, scene.kind == BOX, scene.kind == CYLINDER], [SHELL, BUOY, BLOCK, PILE], ROCK
        ).astype(np.uint8)
        paint = np.empty((count, 3))
        for material, colours in ((SHELL, _SHELLS), (ROCK, _ROCKS), (BUOY, _BUOYS), (PILE, [_PILE]), (BLOCK, [_BLOCK])):
            chosen = np.asarray(colours)[rng.integers(0, len(colours), count)]
            paint[kind == material] = chosen[kind == material]
        surfaces = {"shell": SHELL, "rock": ROCK, "pile": PILE, "block": BLOCK, "buoy": BUOY, "card": CARD}
        for i, name in enumerate(scene.looks):
            if name is not None:
                look = catalogue().looks[name]
                kind[i], paint[i] = surfaces[look.surface], look.colours[int(fate[i, 0] * len(look.colours))]
        # Neighbours differ in lightness, and a little in colour.
        paint *= rng.uniform(0.75, 1.2, (count, 1)) * rng.uniform(0.95, 1.05, (count, 3))
        return cls(kind, np.clip(paint, 0.01, 0.95), fate)


@dataclass(frozen=True)
class SeaFloor:
    """A raster of the sea floor."""

    origin: tuple[float, float]
    """World position of the middle of cell (0, 0) (m)."""
    cell_m: float
    values: NDArray[np.uint8]
    """Share of the sun that is seen, share of the sky, and density of shell debris; 255 stands for 1.
    Shape=(NY, NX, 3)."""

    @classmethod
    @lru_cache(maxsize=2)  # the camera's pictures and the stills are of one scene
    def of(cls, scene: Scene, sun: tuple[float, float, float], softness: float = 0.06) -> SeaFloor:
        """Rasterise a scene; `sun` is a unit vector towards the sun, under water.

        `softness` is the width of a shadow's edge by the distance to what casts it: waves and haze blur the sun.
        """
        if not len(scene):
            return cls((0.0, 0.0), 1.0, np.array([[[255, 255, 0]]], np.uint8))
        low = scene.center[:, :2].min(axis=0) - _MARGIN_M
        extent = scene.center[:, :2].max(axis=0) + _MARGIN_M - low
        cell = max(_CELL_M, float(np.sqrt(extent[0] * extent[1] / _MOST_CELLS)))
        nx, ny = (int(n) + 1 for n in np.ceil(extent / cell))
        values = np.empty((ny, nx, 3), np.float32)
        values[:] = (1.0, 1.0, 0.0)
        rasterise_ground(
            (float(low[0]), float(low[1]), scene.seabed_z),
            cell,
            sun,
            softness,
            scene.solids,
            scene.label == Label.OYSTER,
            values,
        )
        shares = np.round(255.0 * np.minimum(values, 1.0)).astype(np.uint8)
        return cls((float(low[0]), float(low[1])), cell, shares)


@cache
def noise_tile(seed: int) -> NDArray[np.uint8]:
    """Make a tile that repeats without a seam, and its coarser levels, each half the size of the one before.

    The texels of all levels, row by row, from fine to coarse; 0 to 255 stand for 0 to 1.
    Shape=((4 TILE_PX^2 - 1) / 3, 4).
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
    frequency = np.fft.fftfreq(TILE_PX) * TILE_PX
    radius = np.hypot(frequency[:, None], frequency[None, :])
    radius[0, 0] = np.inf
    spectrum = np.fft.fft2(rng.standard_normal((TILE_PX, TILE_PX))) * radius**-slope
    field = np.fft.ifft2(spectrum).real
    return np.asarray(np.clip(0.5 + 0.2 * field / field.std(), 0.0, 1.0))


def _cells(rng: np.random.Generator, count: int, *, flakes: bool) -> NDArray[np.float64]:
    """Return scattered bits, darkness between them: tilted flakes with sharp edges, or round pebbles."""
    field = np.zeros((TILE_PX, TILE_PX))
    reach = 14
    v, u = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    for x, y, angle, size, shape, light in zip(
        rng.uniform(0, TILE_PX, count),
        rng.uniform(0, TILE_PX, count),
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
        rows, columns = (i + v) % TILE_PX, (j + u) % TILE_PX
        field[rows, columns] = np.maximum(field[rows, columns], bit)
    return field
