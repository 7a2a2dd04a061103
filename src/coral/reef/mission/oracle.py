"""A tour planned with full knowledge of the reef: a reference for the time to inspect everything.

It is a heuristic, not a proven optimum: viewpoints by greedy set cover, their order by nearest neighbour, 2-opt and
Or-opt over geodesic distances, then a local search on the tour as driven. The best tour may be faster.
"""

from __future__ import annotations

import itertools
import math
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.costfield import CostField, CostFieldCfg, slowness_over
from coral.reef.map.mapping import distance_to
from coral.reef.mission.tour import drive_path
from coral.reef.pilot.stops import (
    Place,
    Sightings,
    Stop,
    greedy_cover,
    order_stops,
    rearranged,
    shifted,
    unturned,
    without,
)
from coral.reef.simulation.imaging import ImagingCfg, ImagingMeter
from coral.reef.simulation.imaging_kernels import INSPECTED
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.reachability import free_space, obstacle_outline
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld

GRIDS_M, HEADINGS = (0.5, 0.65, 0.8), 12
"""Spacings of candidate viewpoints, with a search from each of which the best counts; headings per viewpoint."""
SLACK = 0.005
"""Share of what can be inspected that the tour may leave out: single points in corners would need long detours."""
EVALUATIONS = 1500
"""Most tours that the local search drives, from each start."""
FIELD_MEMORY, LEAST_FIELDS = 256 << 20, 64
"""Memory (bytes) for cached path lengths, of which each place has a map, and the least number of maps kept."""
LOOK_PERIOD = 4
"""Only every fourth picture counts while tours are compared. All pictures of the chosen tour count."""


@dataclass(frozen=True)
class Tour:
    """A tour, tick by tick."""

    commands: NDArray[np.float64]
    """Forward speed (m/s) and yaw rate (rad/s) of each tick. Shape=(K, 2)."""
    poses: NDArray[np.float64]
    """Poses at the start and after each tick. Shape=(K + 1, 3)."""
    inspected: NDArray[np.float64]
    """Share inspected at these poses. Shape=(K + 1,)."""
    stops: tuple[Stop, ...]
    """Stops of the tour, in order."""
    dt: float
    """Control period (s)."""

    def time_to(self, share: float) -> float | None:
        """Return the time at which a share is inspected (s); None if it never is."""
        reached = np.flatnonzero(self.inspected >= share - 1e-6)
        return round(float(reached[0]) * self.dt, 3) if reached.size else None


def plan_tour(
    world: ReefWorld,
    camera: CameraCfg,
    imaging: ImagingCfg,
    visibility_m: float | None,
    vehicle: VehicleCfg,
    dt: float = 0.1,
) -> Tour:
    """Plan a fast tour that inspects all that can be inspected, up to `SLACK`. Deterministic.

    `visibility_m` is None in clear water. The vehicle gives hull radius, speed and yaw rate; it has no inertia here.
    """
    meter = ImagingMeter(Scene.from_world(world), camera, imaging, visibility_m=visibility_m)
    planner = _Planner(meter, world, vehicle, dt)
    tours = [planner.search(spacing) for spacing in GRIDS_M]
    # All starts share one target: what one of them can inspect, the others must inspect too.
    target = max(target for target, _ in tours)
    routes = [planner.improve(planner.complete(route, target), target) for _, route in tours]
    return planner.tour(min(routes, key=lambda route: planner.seconds(route, target)), target)


class _Planner:
    """Searches, drives and compares tours in one world."""

    def __init__(self, meter: ImagingMeter, world: ReefWorld, vehicle: VehicleCfg, dt: float) -> None:
        self.meter = meter
        self.start = Pose(world.start.x, world.start.y, world.start.theta)
        self.vehicle, self.dt = vehicle, dt
        self.weight: NDArray[np.float64] = 1.0 / (len(world.clusters) * self.meter.size[self.meter.group])
        """Share that each point adds. Shape=(M,)."""
        outlines = [obstacle_outline(obstacle) for obstacle in world.solids]
        space = free_space(world.size_m, outlines, self.start[:2])
        self._cell_m, self._clearance = space.cell_m, distance_to(space.solid, space.cell_m)
        # Paths keep away from obstacles if there is room: a vehicle that follows one cuts corners by a few centimetres.
        self._paths = CostFieldCfg(radius_m=vehicle.hull_radius_m + 0.05, band_m=0.2, penalty=1.0)
        self._slowness = slowness_over(self._clearance, self._cell_m, self._paths)
        self._coarse_m = self._cell_m * self._paths.ratio
        self._fields: OrderedDict[Place, CostField] = OrderedDict()
        cells = self._clearance.size / self._paths.ratio**2
        self._most_fields = max(LEAST_FIELDS, int(FIELD_MEMORY / (5 * cells)))
        self._legs: dict[tuple[float, ...], NDArray[np.float64]] = {}
        self._views: list[tuple[NDArray[np.float64], Sightings]] = []

    def search(self, spacing_m: float) -> tuple[float, list[Stop]]:
        """Return the share that can be inspected, minus the slack, and stops that cover it, in a short order."""
        poses, seen = self._candidates(spacing_m)
        self._views.append((poses, seen))
        stops = [(float(x), float(y), math.nan) for x, y, _ in poses[greedy_cover(seen, self.weight)]]
        target = float(self.weight[seen.seen()].sum()) - SLACK if len(poses) else 0.0
        return target, [stops[k] for k in order_stops(self._distances(stops))]

    def _candidates(self, spacing_m: float) -> tuple[NDArray[np.float64], Sightings]:
        """Return viewpoints that the hull can reach, Shape=(V, 3), and the points that each inspects."""
        xy, reach = self.meter.points[:, :2], self.meter.inspection_m
        low, high = xy.min(axis=0) - reach, xy.max(axis=0) + reach
        axes = [np.arange(a, b + spacing_m, spacing_m) for a, b in zip(low, high, strict=True)]
        places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
        height, width = self._clearance.shape
        i, j = np.floor(places / self._cell_m).astype(np.int64).T
        places = places[(i >= 0) & (j >= 0) & (i < width) & (j < height)]
        i, j = np.floor(places / self._cell_m).astype(np.int64).T
        places = places[self._clearance[j, i] >= self.vehicle.hull_radius_m + 0.1]
        x, y = np.ascontiguousarray(places.T)
        places = places[np.isfinite(self._field(self.start[:2]).lengths(x, y))]
        poses, seen = [], []
        for x, y in places.tolist():
            if float(np.hypot(xy[:, 0] - x, xy[:, 1] - y).min()) > reach:
                continue
            for theta in np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS):
                level, count = self._nothing()
                self.meter.look(Pose(x, y, float(theta)), level, count)
                if count[INSPECTED].any():
                    poses.append((x, y, float(theta)))
                    seen.append(np.flatnonzero(level == INSPECTED))
        return np.array(poses).reshape(-1, 3), Sightings.of(seen, len(xy))

    def _distances(self, stops: Sequence[Stop]) -> NDArray[np.float64]:
        """Compute path lengths (m) from the start and every stop to every stop. Shape=(N + 1, N)."""
        x, y = np.array([self.start[:2], *(stop[:2] for stop in stops)]).T
        columns = [self._field(stop[:2]).lengths(x, y) for stop in stops]
        return np.stack(columns, axis=1) if stops else np.empty((1, 0))

    def complete(self, route: list[Stop], target: float) -> list[Stop]:
        """Add stops with a heading until the target is met, each where it adds the least time.

        A view is added once: a drive that does not quite get there sees less than the view does, and would never end.
        """
        poses = np.concatenate([poses for poses, _ in self._views])
        seen = Sightings.together([seen for _, seen in self._views])
        added = np.zeros(len(poses), np.bool_)
        while True:
            _, level = self._drive(route, target)
            if float(self.weight[level == INSPECTED].sum()) >= target:
                return route
            gain = seen.worth(np.where(level == INSPECTED, 0.0, self.weight))
            chosen = int(np.argmax(np.where(added, 0.0, gain)))
            if added[chosen] or gain[chosen] <= 0.0:
                return route
            added[chosen] = True
            x, y, theta = map(float, poses[chosen])
            options = [[*route[:k], (x, y, theta), *route[k:]] for k in range(len(route) + 1)]
            route = min(options, key=self._length)

    def improve(self, route: list[Stop], target: float) -> list[Stop]:
        """Remove, turn and move stops as long as the driven tour becomes faster."""
        best, evaluations, better = self.seconds(route, target), 0, True
        while better and evaluations < EVALUATIONS:
            better = False
            for change in (without, unturned, rearranged, shifted):
                for changed in change(route):
                    if change is rearranged and self._length(changed) > self._length(route) + 2.0:
                        continue
                    if evaluations >= EVALUATIONS:
                        break
                    evaluations += 1
                    found = self.seconds(changed, target)
                    if found < best - 1e-9:
                        route, best, better = changed, found, True
                        break
                if better:
                    break
        return route

    def seconds(self, route: Sequence[Stop], target: float) -> float:
        """Return the time until the driven tour meets the target (s); inf if it never does."""
        return self._drive(route, target)[0]

    def tour(self, route: Sequence[Stop], target: float) -> Tour:
        """Return the tour tick by tick, until the target is met."""
        commands, poses = self._follow(route)
        level, count = self._nothing()
        shares = []
        for x, y, theta in poses:
            self.meter.look(Pose(x, y, theta), level, count)
            shares.append(float((count[INSPECTED] / self.meter.size).mean()))
            if shares[-1] >= target:
                break
        n = len(shares)
        return Tour(commands[: n - 1], poses[:n], np.array(shares), tuple(route), self.dt)

    def _drive(self, route: Sequence[Stop], target: float) -> tuple[float, NDArray[np.uint8]]:
        """Return the time at which the target is met (s; inf: never) and the levels of the points by then."""
        _, poses = self._follow(route)
        level, count = self._nothing()
        met = self.meter.look_along(poses, level, count, every=LOOK_PERIOD, target=target)
        return math.inf if met is None else met * self.dt, level

    def _follow(self, route: Sequence[Stop]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return commands and poses of the drive to all stops. At a stop with a heading the vehicle turns to it."""
        commands, poses = np.empty((0, 2)), np.array([self.start])
        path, at = [poses[:, :2]], self.start[:2]
        for k, (x, y, theta) in enumerate(route):
            path.append(self._leg(at, (x, y)))
            at = x, y
            if math.isfinite(theta) or k == len(route) - 1:
                spare = math.ceil(40.0 / self.dt)
                driven = drive_path(np.concatenate(path), Pose(*poses[-1]), self.vehicle, self.dt, spare)
                commands, poses = np.concatenate([commands, driven[0]]), np.concatenate([poses, driven[1]])
                path = [poses[-1:, :2]]
            if math.isfinite(theta):
                turned = self._turn(poses[-1], theta)
                commands, poses = np.concatenate([commands, turned[0]]), np.concatenate([poses, turned[1]])
        return commands, poses

    def _turn(self, pose: NDArray[np.float64], theta: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        turn = math.remainder(theta - float(pose[2]), 2.0 * math.pi)
        ticks = math.ceil(abs(turn) / (self.vehicle.max_yaw_rate_rad_s * self.dt))
        poses = np.repeat(pose[None], ticks, axis=0)
        poses[:, 2] += turn * np.arange(1, ticks + 1) / max(ticks, 1)
        return np.stack([np.zeros(ticks), np.full(ticks, turn / max(ticks, 1) / self.dt)], axis=1), poses

    def _length(self, route: Sequence[Stop]) -> float:
        places = [self.start[:2], *(stop[:2] for stop in route)]
        return sum(self._way_m(a, b) for a, b in itertools.pairwise(places))

    def _way_m(self, a: Place, b: Place) -> float:
        """Return the path length between two places (m), from either cached field."""
        return self._field(a).lookup(*b) if a in self._fields and b not in self._fields else self._field(b).lookup(*a)

    def _leg(self, a: Place, b: Place) -> NDArray[np.float64]:
        """Return the path from one place to another. Shape=(N, 2), metres."""
        if (*a, *b) not in self._legs:
            if a in self._fields and b not in self._fields:
                way = self._field(a).path_from(*b, step_m=0.05, length_m=400.0)[::-1]
            else:
                way = self._field(b).path_from(*a, step_m=0.05, length_m=400.0)
            self._legs[*a, *b] = way
        return self._legs[*a, *b]

    def _field(self, goal: Place) -> CostField:
        """Return the path lengths to a place. The least recently used are given up, and computed again when needed."""
        if goal not in self._fields:
            self._fields[goal] = CostField.over(self._slowness, goal, cell_m=self._coarse_m, cfg=self._paths)
            while len(self._fields) > self._most_fields:
                self._fields.popitem(last=False)
        self._fields.move_to_end(goal)
        return self._fields[goal]

    def _nothing(self) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        return np.zeros(len(self.meter.points), np.uint8), np.zeros((3, len(self.meter.size)), np.int64)
