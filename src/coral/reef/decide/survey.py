"""What is left to explore, from the robot's own map: frontiers, dead ends, distances along known water."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.config import CellSize, Positive
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.route import Arrival
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.map.mapping import OccupancyMap
from coral.reef.world.geometry import bearing


@dataclass(frozen=True, kw_only=True)
class SurveyCfg:
    """CellSize and thresholds of the survey of what is left."""

    cell_m: CellSize = 0.2
    """Edge of the coarse cells that frontiers are found on."""
    min_region_m2: float = 1.5
    """Unexplored regions smaller than this are shadows behind obstacles, not something to explore."""
    min_frontier_m: float = 0.8
    """Shorter frontiers are ignored."""
    tile_m: Positive = 3.0
    """Longer frontiers are cut into pieces of about this size."""
    gain_radius_m: Positive = 3.0
    """How far about a point unexplored water counts as what a visit would show."""
    ahead_deg: float = 60.0
    ahead_m: float = 6.0
    """A dead end has no frontier within this angle and path length in front of the robot..."""
    reef_reach_m: float = 5.0
    """... that lies this near to a known cluster: water farther off is no longer the reef."""
    border_m: float = 0.5
    """The outermost strip of the survey area is not worth a visit."""
    look_m: Positive = 5.0
    """Water within this of the way there, and in front of it, will be explored on arrival; less than the map's 6 m,
    since obstacles hide some of it."""
    look_deg: float = 55.0
    """The same to either side of the heading: a little less than the camera's half angle of view."""


@dataclass(frozen=True, kw_only=True)
class Frontier:
    """A piece of the border between explored and unexplored water that the robot can reach."""

    x: float
    y: float
    length_m: float
    path_m: float
    """Length of the known way there (m)."""
    bearing: float
    """Off the robot's heading (rad, left positive)."""
    unexplored: float
    """Unexplored share of its surroundings (within the gain radius)."""
    reef_m: float
    """Distance to the nearest known oyster cluster (m); inf when none is known."""


@dataclass(frozen=True)
class Survey:
    """What is left to explore at one moment."""

    frontiers: tuple[Frontier, ...]
    field: CostField
    """Geodesic distances from the robot."""
    dead_end: bool
    gain_radius_m: float

    def path_m(self, x: float, y: float, within_m: float = 0.7) -> float:
        """Length of the known way from the robot to within `within_m` of a point (m); inf when there is none."""
        return self.field.lookup(x, y) if self.field.reaches(x, y, within_m) else math.inf


def survey(outlook: Outlook, field_cfg: CostFieldCfg, forward_m: float, cfg: SurveyCfg) -> Survey:
    """Analyse the map as it will be on arrival; from `forward_m` on a centroid counts as ahead (Alg. 2, d_min)."""
    belief, arrival, pose = outlook.belief, outlook.arrival, outlook.arrival.pose
    water = belief.water(field_cfg)
    field = CostField.over(water.slowness, (pose.x, pose.y), cell_m=water.cell_m, cfg=field_cfg)
    left = Survey(frontiers=(), field=field, dead_end=False, gain_radius_m=cfg.gain_radius_m)
    frontiers = _frontiers(belief, left, cfg, arrival)
    near_ahead = any(
        abs(f.bearing) <= math.radians(cfg.ahead_deg)
        and f.path_m <= cfg.ahead_m
        and (f.reef_m <= cfg.reef_reach_m or not belief.tracks)
        for f in frontiers
    )
    dead_end = not near_ahead and not outlook.ahead(forward_m)
    return replace(left, frontiers=tuple(frontiers), dead_end=dead_end)


def _frontiers(belief: Belief, left: Survey, cfg: SurveyCfg, arrival: Arrival) -> list[Frontier]:
    cells, cell_m = belief.map, cfg.cell_m
    k = max(1, round(cell_m / cells.cfg.cell_m))
    explored = _coarse(cells.explored, k).mean(axis=(1, 3)) > 0.5
    solid = _coarse(cells.obstacle, k).any(axis=(1, 3))
    if arrival.in_s > 0.0:
        _explore_ahead(explored, arrival, cell_m, replace(cfg, look_m=min(cfg.look_m, cells.sees_m)))
    unknown = _worth_a_visit(~explored & ~solid, cfg)
    touching = cv2.dilate(unknown, np.ones((3, 3), np.uint8)).astype(bool)
    ys, xs = np.nonzero(touching & explored & ~solid)
    px, py = np.asarray((xs + 0.5) * cell_m), np.asarray((ys + 0.5) * cell_m)
    path = left.field.lengths(px, py)
    keep = np.isfinite(path)
    xs, ys, px, py, path = xs[keep], ys[keep], px[keep], py[keep], path[keep]
    edge_mask = np.zeros(explored.shape, np.uint8)
    edge_mask[ys, xs] = 1
    _, pieces = cv2.connectedComponents(edge_mask, connectivity=8)
    tile = max(1, round(cfg.tile_m / cell_m))
    key = (pieces[ys, xs].astype(np.int64) * 4096 + ys // tile) * 4096 + xs // tile
    reef = belief.reef()
    found = []
    for group in np.unique(key):
        members = np.flatnonzero(key == group)
        if members.size * cell_m < cfg.min_frontier_m:
            continue
        mean = np.array([px[members].mean(), py[members].mean()])
        best = members[np.argmin((px[members] - mean[0]) ** 2 + (py[members] - mean[1]) ** 2)]
        x, y = float(px[best]), float(py[best])
        if not belief.worth_exploring(x, y):
            continue
        found.append(
            Frontier(
                x=x,
                y=y,
                length_m=float(members.size * cell_m),
                path_m=float(path[best]),
                bearing=bearing(arrival.pose, x, y),
                unexplored=belief.map.unexplored_share(x, y, cfg.gain_radius_m),
                reef_m=float(np.min(np.hypot(reef[:, 0] - x, reef[:, 1] - y))) if len(reef) else math.inf,
            )
        )
    return sorted(found, key=lambda f: f.path_m)


def idle_water(cells: OccupancyMap, cfg: SurveyCfg) -> NDArray[np.bool_]:
    """Return the unexplored cells that are not worth a visit: pieces too small, and the rim. Shape=(NY, NX)."""
    k = max(1, round(cfg.cell_m / cells.cfg.cell_m))
    explored = _coarse(cells.explored, k).mean(axis=(1, 3)) > 0.5
    worth = np.repeat(
        np.repeat(_worth_a_visit(~explored & ~_coarse(cells.obstacle, k).any(axis=(1, 3)), cfg), k, 0), k, 1
    )
    ny, nx = cells.explored.shape
    idle: NDArray[np.bool_] = ~cells.explored
    idle[: worth.shape[0], : worth.shape[1]] &= worth[:ny, :nx] == 0
    return idle


def _worth_a_visit(unknown: NDArray[np.bool_], cfg: SurveyCfg) -> NDArray[np.uint8]:
    """Return unknown water without small pieces and without the rim, on the coarse grid. Shape=(NY, NX)."""
    worth, edge = unknown.astype(np.uint8), math.ceil(cfg.border_m / cfg.cell_m)
    worth[:edge], worth[-edge:], worth[:, :edge], worth[:, -edge:] = 0, 0, 0, 0
    count, labels, stats, _ = cv2.connectedComponentsWithStats(worth, connectivity=4)
    for region in range(1, count):
        if stats[region, cv2.CC_STAT_AREA] * cfg.cell_m**2 < cfg.min_region_m2:
            worth[labels == region] = 0
    return worth


def _explore_ahead(explored: NDArray[np.bool_], arrival: Arrival, cell_m: float, cfg: SurveyCfg) -> None:
    """Mark what the robot will have seen on the way, Shape=(NY, NX), in place."""
    reach = math.ceil(cfg.look_m / cell_m)
    for x, y, theta in arrival.path[::2][:-1].tolist() + arrival.path[-1:].tolist():
        iy, ix = int(y / cell_m), int(x / cell_m)
        y0, x0 = max(iy - reach, 0), max(ix - reach, 0)
        window = explored[y0 : iy + reach + 1, x0 : ix + reach + 1]
        if not window.size:
            continue
        dy = (np.arange(y0, y0 + window.shape[0]) + 0.5) * cell_m - y
        dx = (np.arange(x0, x0 + window.shape[1]) + 0.5) * cell_m - x
        off = np.arctan2(dy[:, None], dx[None, :]) - theta
        turned = np.abs(np.arctan2(np.sin(off), np.cos(off)))
        window |= (np.hypot(dx[None, :], dy[:, None]) <= cfg.look_m) & (turned <= math.radians(cfg.look_deg))


def _coarse(mask: NDArray[np.bool_], k: int) -> NDArray[np.bool_]:
    """View of a mask in k by k blocks, Shape=(NY // k, k, NX // k, k); a ragged border is dropped."""
    ny, nx = mask.shape[0] // k, mask.shape[1] // k
    return mask[: ny * k, : nx * k].reshape(ny, k, nx, k)
