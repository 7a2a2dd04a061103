"""Marine snow: particles that drift through the water near the camera."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

CELL_M = 0.2
"""Edge of the cells in which particles are drawn by lot."""
REACH_M = 1.6
"""Farther particles are smaller than a pixel and part of the veil."""


@njit(cache=True, error_model="numpy")
def draw_snow(
    pose: NDArray[np.float64],
    focal: float,
    centre: tuple[float, float],
    drift: tuple[float, float, float],
    floor_z: float,
    chance: float,
    light: tuple[float, float, float],
    lost: tuple[float, float, float],
    seed: int,
    depth: NDArray[np.float32],
    image: NDArray[np.float32],
) -> int:
    """Add the light of particles, blurred by the lens when they are near. Return how many are in the picture.

    Args:
        pose: Shape=(4, 4), camera optical frame to world.
        focal: Focal length (px).
        centre: Principal point (px).
        drift: How far the water has moved (m).
        floor_z: Height of the sea floor (m).
        chance: Probability of a particle in a cell.
        light: Light that a white surface sends back at the camera's depth.
        lost: Attenuation (1/m).
        seed: Of the particles.
        depth: Shape=(H, W), what hides them.
        image: Shape=(H, W, 3), added to.
    """
    height, width = depth.shape
    reach = int(REACH_M / CELL_M) + 1
    ox, oy, oz = pose[0, 3] - drift[0], pose[1, 3] - drift[1], pose[2, 3] - drift[2]
    ci, cj, ck = math.floor(ox / CELL_M), math.floor(oy / CELL_M), math.floor(oz / CELL_M)
    drawn = 0
    for i in range(ci - reach, ci + reach + 1):
        for j in range(cj - reach, cj + reach + 1):
            for k in range(ck - reach, ck + reach + 1):
                if _lot(i, j, k, seed, 0) >= chance:
                    continue
                a, b, c, size = (
                    _lot(i, j, k, seed, 1),
                    _lot(i, j, k, seed, 2),
                    _lot(i, j, k, seed, 3),
                    _lot(i, j, k, seed, 4),
                )
                dx, dy, dz = (i + a) * CELL_M - ox, (j + b) * CELL_M - oy, (k + c) * CELL_M - oz
                z = pose[0, 2] * dx + pose[1, 2] * dy + pose[2, 2] * dz
                if z < 0.06 or pose[2, 3] + dz < floor_z:
                    continue
                u = centre[0] + focal * (pose[0, 0] * dx + pose[1, 0] * dy + pose[2, 0] * dz) / z
                v = centre[1] + focal * (pose[0, 1] * dx + pose[1, 1] * dy + pose[2, 1] * dz) / z
                # Flakes of 0.5 to 4 mm, few of them large; a wide lens blurs what is nearer than a hand's breadth.
                wide = focal * (0.0005 + 0.0035 * size * size * size) / z
                blur = math.sqrt(0.45 * 0.45 + (focal * 0.0012 / z) ** 2 + 0.25 * wide * wide)
                if not (-3.0 * blur < u < width + 3.0 * blur and -3.0 * blur < v < height + 3.0 * blur):
                    continue
                strength = 0.5 * wide * wide / (2.0 * math.pi * blur * blur)
                drawn += 1
                for row in range(max(int(v - 3.0 * blur), 0), min(int(v + 3.0 * blur) + 2, height)):
                    for column in range(max(int(u - 3.0 * blur), 0), min(int(u + 3.0 * blur) + 2, width)):
                        if depth[row, column] < z:
                            continue
                        away = ((row - v) ** 2 + (column - u) ** 2) / (2.0 * blur * blur)
                        if away > 4.5:
                            continue
                        share = min(strength * math.exp(-away), 0.8)
                        for n in range(3):
                            bright = light[n] * math.exp(-lost[n] * z)
                            image[row, column, n] += share * max(bright - image[row, column, n], 0.0)
    return drawn


@njit(cache=True, error_model="numpy")
def _lot(i: int, j: int, k: int, seed: int, number: int) -> float:
    """Return a number from 0 to 1 that belongs to a cell."""
    mix = np.uint32(i & 0xFFFF) * np.uint32(73856093) ^ np.uint32(j & 0xFFFF) * np.uint32(19349663)
    mix ^= np.uint32(k & 0xFFFF) * np.uint32(83492791) ^ np.uint32(seed) ^ np.uint32(number) * np.uint32(2654435761)
    mix = np.uint32(mix * np.uint32(747796405) + np.uint32(2891336453))
    word = np.uint32(((mix >> ((mix >> np.uint32(28)) + np.uint32(4))) ^ mix) * np.uint32(277803737))
    return float(np.uint32((word >> np.uint32(22)) ^ word)) / 4294967296.0
