"""The obstacle layer: what the sonar has heard of the grid, apart from what the camera has seen."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Count, NonNegative, Positive
from coral.reef.map.carried import around
from coral.reef.map.layer_kernels import LEVEL, LOW, count, mark
from coral.reef.map.sonar_3d15 import SonarCfg, sonar_attitude
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.world.geometry import Pose


@dataclass(frozen=True, kw_only=True)
class SonarLayerCfg:
    """What an echo must be to stand on the map. The paper names the sensor, not these figures."""

    floor_m: Positive = 0.25
    """Echoes lower than this above the sea floor are the floor or oysters: those of the shipped reefs reach 0.18 m."""
    above_m: Positive = 1.0
    """Echoes higher than this above the vehicle are out of its way."""
    surface_m: NonNegative = 0.15
    """Echoes from less than this below the surface are the surface."""
    hits: Count = 2
    """Images that must have an echo in a cell before it is an obstacle: 0.4 s at 5 Hz. One wrong echo has no effect."""
    ratio: NonNegative = 0.3
    """A cell is no obstacle if fewer images have an echo there than this share of those whose beams pass through."""
    remembered: Annotated[int, Field(ge=4, le=60000)] = 32
    """Images of one kind at which both counts of a cell are halved: old clear water must not outvote a new echo."""
    range_m: Annotated[float, Field(gt=0, le=15)] = 4.0
    """Obstacle sensing range (paper IV-F)."""
    clear_m: Annotated[float, Field(gt=0, le=15)] = 6.0
    """Range of what is known to be clear: that of the map."""
    low_m: Positive = 0.35
    """A beam at most this high above the floor proves that no obstacle stands there."""
    level_m: Positive = 0.2
    """A beam within this much of the vehicle's height proves that nothing floats in its way."""
    back_m: NonNegative = 0.15
    """A beam says nothing about this much water before its echo: five standard deviations of a range at 6 m."""


class ObstacleLayer:
    """Counts for each cell the range images with an echo there and those whose beams pass through at its height."""

    def __init__(
        self, shape: tuple[int, int], cell_m: float, sonar: SonarCfg, cfg: SonarLayerCfg | None = None
    ) -> None:
        """Set up for a grid of `shape` (rows, columns) with cells of `cell_m` (m)."""
        self.cfg, self.sonar, self._cell_m = cfg or SonarLayerCfg(), sonar, cell_m
        self.obstacle = np.zeros(shape, np.bool_)
        """Obstacle cells. Shape=(NY, NX)."""
        self._hits, self._through = np.zeros(shape, np.uint16), np.zeros(shape, np.uint16)
        self._clear, self._said = np.zeros(shape, np.uint8), np.zeros(shape, np.uint8)
        self._height = np.full(shape, np.nan, np.float32)

    @property
    def grids(self) -> tuple[NDArray[Any], ...]:
        """Arrays that say what is known of each cell. Shape=(NY, NX)."""
        return self.obstacle, self._hits, self._through, self._clear

    @property
    def free(self) -> NDArray[np.bool_]:
        """Cells in which nothing stands and nothing floats at the vehicle's height. Shape=(NY, NX)."""
        return np.asarray((self._clear == LOW | LEVEL) & ~self.obstacle)

    def integrate(
        self,
        image: RangeImage,
        pose: Pose,
        altitude_m: float,
        *,
        roll: float = 0.0,
        pitch: float = 0.0,
        depth_m: float = math.inf,
    ) -> bool:
        """Fuse a range image of any geometry taken at `pose`; a positive pitch (rad) lowers the nose."""
        cfg = self.cfg
        top = altitude_m + min(cfg.above_m, depth_m - cfg.surface_m)
        mark(
            image.ranges,
            image.directions(),
            sonar_attitude(pose.theta, roll, pitch, self.sonar.pitch_down_deg),
            (pose.x, pose.y, altitude_m),
            self._cell_m,
            (cfg.floor_m, top),
            cfg.low_m,
            (altitude_m - cfg.level_m, altitude_m + cfg.level_m),
            cfg.clear_m,
            cfg.range_m,
            cfg.back_m,
            self._height,
            self._said,
        )
        reach_m = max(cfg.range_m, cfg.clear_m)
        return bool(
            count(
                self._said,
                around(pose.x, pose.y, reach_m, self._cell_m, self.obstacle.shape),
                cfg.hits,
                cfg.ratio,
                self._hits,
                self._through,
                self._clear,
                self.obstacle,
                cfg.remembered,
            )
        )
