"""Landmarks in a camera picture: obstacles that stand on the seabed, each as an upright round body."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Positive
from coral.reef.map.landmarks_kernels import scan
from coral.reef.vehicle.camera import CameraCfg, check_picture, pixel_rays
from coral.reef.world.geometry import Frame

WIDEST_SINE = 0.6
"""Of half the angle under which a body appears: nearer ones are larger than what they show."""
RANGE_SIGMA_M = 0.1
"""Standard deviation of the distance to the centre of a thin post (m). Along one mission on s1 it was 0.04 m for round
bodies and 0.18 m for those 1.6 times as long as wide, or longer. The last picture's error counts once: with twice as
much, wrong matches seemed likely enough to be kept."""
DOUBTED_SIGMA_M = 0.4
"""The same by the depth of a network. In `bay` water it put 2461 bodies 0.3 m too far away (median), with a spread of
0.3 m; their bearings were as good as in exact pictures (docs/research/network-eyes.md)."""


@dataclass(frozen=True, kw_only=True)
class LandmarkCfg:
    """What counts as a landmark in a picture."""

    range_m: Positive = 5.0
    """Farther obstacles are not measured: at 5 m their pixels are 11 cm apart. Of eyes that doubt, those as far as they
    tell oysters from sea floor (`OccupancyMap.sees_m`), if that is nearer."""
    sector_deg: Positive = 1.0
    """Width of a sector of bearing: about one column at the picture's centre."""
    sector_px: Count = 10
    """Fewest obstacle pixels in a sector. A rock 1.2 m high has 18 there at 3 m; a wrong patch of a mask has 6."""
    body_px: Count = 60
    """Fewest obstacle pixels of a body: nearly twice a wrong patch of 6 x 6."""
    split_m: Positive = 0.4
    """Pixels of one sector that are farther apart show two bodies, one behind the other."""
    jump_m: Positive = 0.3
    """A larger step in range between neighbouring sectors separates two bodies."""
    margin: Count = 2
    """Sectors at either edge of the view in which no outline ends: there the picture may cut the body."""


@dataclass(frozen=True)
class Sighting:
    """A standing body as one picture shows it; bearings in the body frame (rad, left positive)."""

    right: float | None
    """Bearing of its right outline; None where the picture or a nearer body cuts it off."""
    left: float | None
    """The same for its left outline. At least one of the two is seen."""
    near_m: float
    """Horizontal distance from the camera to its surface."""
    width: float
    """Angle that is seen of it (rad)."""
    sigma_m: float = RANGE_SIGMA_M
    """Standard deviation of the distance, for a thin post (m)."""

    @property
    def whole(self) -> bool:
        """Whether both outlines are seen."""
        return self.right is not None and self.left is not None

    @property
    def radius_m(self) -> float:
        """Radius of the circle that appears under this angle at this distance; too small for one seen in part."""
        sine = min(math.sin(0.5 * self.width), WIDEST_SINE)
        return self.near_m * sine / (1.0 - sine)


class LandmarkDetector:
    """Finds standing obstacles in pictures.

    Pixels are sorted by bearing in the horizontal plane, not by column: in a camera that looks down, an upright post is
    not upright in the picture. The median over the height of a body averages the noise of depth.
    """

    def __init__(self, camera: CameraCfg, cfg: LandmarkCfg | None = None) -> None:
        self.cfg = cfg = cfg or LandmarkCfg()
        self._camera = camera
        rays = pixel_rays(camera)
        self._length: NDArray[np.float64] = np.hypot(rays[..., 0], rays[..., 1])
        self._step = math.radians(cfg.sector_deg)
        self._half = int(0.5 * math.radians(camera.hfov_deg) / self._step)
        sector = np.floor(np.arctan2(rays[..., 1], rays[..., 0]) / self._step).astype(np.int64) + self._half
        self._sector = np.where((sector >= 0) & (sector < 2 * self._half), sector, -1)
        self._ranges = np.empty(2 * self._half)
        self._counts = np.empty(2 * self._half, np.int64)

    def detect(self, frame: Frame, sees_m: float = math.inf) -> list[Sighting]:
        """Return the standing bodies of a picture up to `sees_m` away (m), those that are seen whole first.

        Raises:
            InputError: The picture is not of the configured size and type.
        """
        check_picture(frame, self._camera)
        cfg, ranges = self.cfg, self._ranges
        limits = (min(cfg.range_m, sees_m), cfg.sector_px, cfg.split_m)
        scan(frame.depth, frame.labels, self._sector, self._length, limits, ranges, self._counts)
        standing = np.flatnonzero(np.isfinite(ranges))
        if not standing.size:
            return []
        apart = (np.diff(standing) > 1) | (np.abs(np.diff(ranges[standing])) >= cfg.jump_m)
        bodies = np.split(standing, np.flatnonzero(apart) + 1)
        sigma_m = RANGE_SIGMA_M if frame.doubt is None else DOUBTED_SIGMA_M
        found = [seen for body in bodies if (seen := self._sighting(int(body[0]), int(body[-1]), sigma_m)) is not None]
        return sorted(found, key=lambda seen: not seen.whole)

    def _sighting(self, first: int, last: int, sigma_m: float) -> Sighting | None:
        """Describe the body in the sectors `first` to `last`, from right to left; None if neither outline is seen."""
        cfg, ranges, edge = self.cfg, self._ranges, 2 * self._half - 1 - self.cfg.margin
        if self._counts[first : last + 1].sum() < cfg.body_px:
            return None
        free_right = first > cfg.margin and not ranges[first - 1] < ranges[first]
        free_left = last < edge and not ranges[last + 1] < ranges[last]
        if not (free_right or free_left):
            return None
        surface = ranges[first : last + 1]
        third = len(surface) // 3
        # The middle of a body is nearest to the camera; of one seen in part that is where the smallest range is.
        near = np.median(surface[third : len(surface) - third]) if free_right and free_left else surface.min()
        right, left = (first - self._half) * self._step, (last + 1 - self._half) * self._step
        return Sighting(right if free_right else None, left if free_left else None, float(near), left - right, sigma_m)
