"""What the solids of a scene are made of, to the eye."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.reef.paint.solid_kernels import BLOCK, BUOY, CARD, PILE, ROCK, SHELL
from coral.reef.world.geometry import Label
from coral.reef.world.kinds import catalogue
from coral.reef.world.scene import BOX, CYLINDER, Scene

_SHELLS = np.array([(0.40, 0.38, 0.33), (0.33, 0.29, 0.22), (0.26, 0.25, 0.21), (0.30, 0.26, 0.25), (0.36, 0.36, 0.28)])
"""Chalk, tan, gray, purple brown, olive: outer shells of Crassostrea."""
_ROCKS = np.array([(0.23, 0.21, 0.19), (0.19, 0.19, 0.19), (0.27, 0.23, 0.17)])
_BUOYS = np.array([(0.62, 0.17, 0.03), (0.62, 0.46, 0.05), (0.60, 0.60, 0.58), (0.50, 0.05, 0.04)])
_PILE, _BLOCK = (0.17, 0.12, 0.08), (0.36, 0.35, 0.32)


@dataclass(frozen=True)
class Materials:
    """Material and reflectance of N solids."""

    kind: NDArray[np.uint8]
    """A constant of `solid_kernels`. Shape=(N,)."""
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
