"""Obstacles that a network alone sees: lines of sight over the sea floor, doubtful until seen from two places."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.config import Positive
from coral.reef.map.sight_layer_kernels import scan, trace
from coral.reef.vehicle.camera import CameraCfg, pixel_rays
from coral.reef.world.geometry import Frame, Label, Pose, wrap

NEAR_SHARE = 0.2
"""An obstacle is where this share of its pixels along a bearing is nearer, or at its foot if that is nearer."""
FLOOR_DOUBT = 0.3
"""Floor with more doubt is not seen: there may be oysters. The limit of `DoubtCfg` for oysters."""
GAP_PX = 2
"""A line of sight ends where more rows of floor are missing."""
UNDER_M = 0.2
"""No obstacle is so near to the middle of the vehicle, whose hull has a radius of 0.3 m; the rest is for errors of the
map. One that a network saw there would let it go nowhere: every way begins in it."""
BACK_M = 0.15
BACK_SHARE = 0.1
"""Water within `back_m` and this share of its distance in front of an obstacle is not marked free."""


@dataclass(frozen=True, kw_only=True)
class SightLayerCfg:
    """What a line of sight says of the cells, where obstacles are told by a network's picture alone."""

    through: Positive = 0.5
    """Weight of a look through a cell; a look that ends there weighs 1."""
    most: Positive = 2.0
    """Evidence is bounded by this, that for an obstacle by twice as much: what is looked through is free again."""
    solid: Positive = 1.5
    """Evidence that makes an obstacle: looks from two places."""
    aside_rad: Positive = 0.35
    near_m: Positive = 1.5
    """An obstacle is beyond doubt once two lines of sight this far apart, or one this short, have ended there."""
    step_m: Positive = 0.1
    turn_rad: Positive = 0.1
    """A picture is evidence once the camera has moved or turned this far: errors of a network repeat while it
    stands still."""


class SightLayer:
    """Keeps for each cell the evidence for and against an obstacle."""

    def __init__(
        self, known: NDArray[np.bool_], cell_m: float, camera: CameraCfg, sharp_m: float, cfg: SightLayerCfg
    ) -> None:
        """Set up for a grid with cells of `cell_m` (m), in which obstacles are known. Shape=(NY, NX).

        Looks count fully up to `sharp_m` (m), then less and less.
        """
        self.cfg, self.camera, self._cell_m, self._sharp_m = cfg, camera, cell_m, sharp_m
        self.obstacle = known
        """Obstacle cells. Shape=(NY, NX)."""
        self.odds = np.where(known, 2.0 * cfg.most, 0.0).astype(np.float32)
        """Evidence for an obstacle. Shape=(NY, NX)."""
        self._sure, self._aspect = known.copy(), np.full(known.shape, np.nan, np.float32)
        self._said, self._pictures = np.zeros(known.shape, np.int32), 0
        self._rays = pixel_rays(camera)
        bearings = math.ceil(2.0 * math.pi * camera.intrinsics[0])
        self._scan = np.empty((3, bearings))
        self._last: Pose | None = None
        self.counted = False
        """Whether the last picture was evidence: taken at another place than the one before."""

    @property
    def doubtful(self) -> NDArray[np.bool_]:
        """Obstacle cells that were seen from one side only, and from afar. Shape=(NY, NX)."""
        return np.asarray(self.obstacle & ~self._sure)

    @property
    def grids(self) -> tuple[NDArray[Any], ...]:
        """Arrays that say what is known of each cell. Shape=(NY, NX)."""
        return self.obstacle, self.odds, self._sure, self._aspect

    def forget(self, cells: NDArray[np.bool_]) -> None:
        """Take back what is known of cells. Shape=(NY, NX)."""
        self.obstacle[cells], self.odds[cells], self._aspect[cells] = False, 0.0, np.nan

    def snapshot(self) -> SightLayer:
        """Copy the obstacles and their evidence; nothing may be integrated into the copy."""
        copied = copy.copy(self)
        copied.obstacle, copied.odds, copied._aspect = self.obstacle.copy(), self.odds.copy(), self._aspect.copy()
        copied._sure = self._sure.copy()
        return copied

    def integrate(
        self,
        frame: Frame,
        pose: Pose,
        ranges_m: tuple[float, float],
        explored: NDArray[np.bool_],
        roll: float = 0.0,
        pitch: float = 0.0,
    ) -> bool:
        """Fuse a picture, without its doubtful pixels, taken at `pose`; roll and pitch (rad) as in `T_world_camera`.

        `ranges_m` are the greatest distances (m) of obstacles and of explored cells, Shape=(NY, NX), updated in place.
        """
        cfg, at = self.cfg, self._last
        rays = pixel_rays(self.camera, roll, pitch) if roll or pitch else self._rays
        forward, left, down = rays[..., 0], rays[..., 1], -rays[..., 2]
        flat = np.hypot(forward, left)
        floor = frame.labels == Label.SEABED
        # Eyes put the floor where the measured height puts it.
        height = float(np.median((frame.depth * down)[floor])) if floor.any() else self.camera.altitude_m
        with np.errstate(divide="ignore", invalid="ignore"):
            plane = np.where(down > 1e-6, height * flat / down, np.inf)
        turn = np.arctan2(left, forward) + math.pi
        (ranges, first, last), bearings = self._scan, self._scan.shape[1]
        bearing = np.minimum((turn * (bearings / (2.0 * math.pi))).astype(np.int64), bearings - 1)
        labels = frame.labels
        if frame.doubt is not None:
            labels = np.where(floor & (frame.doubt > FLOOR_DOUBT), np.uint8(Label.WATER), labels)
        scan(frame.depth, labels, flat, plane, bearing, NEAR_SHARE, GAP_PX, ranges, first, last)
        self.counted = (
            at is None or math.dist(at[:2], pose[:2]) >= cfg.step_m or abs(wrap(at.theta - pose.theta)) >= cfg.turn_rad
        )
        if self.counted:
            self._last = pose
            self._pictures += 1
        changed = bool(
            trace(
                ranges,
                first,
                last,
                (pose.x, pose.y),
                pose.theta,
                self._cell_m,
                ranges_m[0],
                ranges_m[1],
                self._sharp_m,
                BACK_M,
                BACK_SHARE,
                cfg.through,
                cfg.most,
                cfg.solid,
                self.counted,
                (cfg.near_m, cfg.aside_rad),
                self.odds,
                self._aspect,
                self._sure,
                self._said,
                self._pictures,
                explored,
                self.obstacle,
            )
        )
        return self._clear_under(pose) or changed

    def _clear_under(self, pose: Pose) -> bool:
        """Free the cells under the vehicle. Returns whether one was an obstacle."""
        iy, ix, reach = (math.floor(value / self._cell_m) for value in (pose.y, pose.x, UNDER_M))
        box = tuple(
            slice(max(at - reach, 0), min(max(at + reach + 1, 0), edge))
            for at, edge in zip((iy, ix), self.obstacle.shape, strict=True)
        )
        if not self.obstacle[box].any():
            return False
        y, x = np.ogrid[box]
        under = np.hypot(x - ix, y - iy) <= reach
        found = bool((self.obstacle[box] & under).any())
        self.obstacle[box][under] = self._sure[box][under] = False
        self.odds[box][under] = np.minimum(self.odds[box][under], 0.0)
        return found
