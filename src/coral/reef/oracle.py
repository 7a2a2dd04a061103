"""A tour that knows the reef: how soon everything could be inspected. A bound for the judge; no robot has it.

It is a heuristic, not a proven optimum: viewpoints by greedy set cover, an order by nearest neighbour, 2-opt and
Or-opt over geodesic distances, then a local search on the tour as it would be driven. The best tour may be faster.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coral.reef.camera import CameraCfg
from coral.reef.costfield import CostField, CostFieldCfg
from coral.reef.geometry import Pose
from coral.reef.imaging import ImagingCfg, ImagingMeter
from coral.reef.imaging_kernels import INSPECTED
from coral.reef.mapping import distance_to
from coral.reef.reachability import free_space, obstacle_outline
from coral.reef.scene import Scene
from coral.reef.tour_kernels import follow
from coral.reef.vehicle import VehicleCfg
from coral.reef.world import ReefWorld

GRID_M, HEADINGS = 0.6, 12
"""Spacing of candidate viewpoints, and headings tried at each."""
SLACK = 0.005
"""Share that the tour may leave out of what can be inspected: single points in corners would cost long detours."""
EVALUATIONS = 500
"""Tours that the local search drives at most."""
LOOK_PERIOD = 3
"""While tours are compared, every third tick's picture is looked at; of the chosen one, all."""

Stop = tuple[float, float, float]
"""A place (m) and the heading to turn to there (rad); nan: whichever it comes with."""


@dataclass(frozen=True)
class Tour:
    """A tour, tick by tick.

    commands: Shape=(K, 2), forward speed (m/s) and yaw rate (rad/s).
    poses: Shape=(K + 1, 3), at the start and after each tick.
    inspected: Shape=(K + 1,), share inspected by then.
    stops: In their order.
    dt: Control period (s).
    """

    commands: NDArray[np.float64]
    poses: NDArray[np.float64]
    inspected: NDArray[np.float64]
    stops: tuple[Stop, ...]
    dt: float

    def time_to(self, share: float) -> float | None:
        """When this share is inspected (s); None when never."""
        reached = np.flatnonzero(self.inspected >= share - 1e-6)
        return round(float(reached[0]) * self.dt, 3) if reached.size else None


def plan_tour(
    world: ReefWorld,
    camera: CameraCfg | None = None,
    imaging: ImagingCfg | None = None,
    *,
    visibility_m: float | None = None,
    vehicle: VehicleCfg | None = None,
    dt: float = 0.1,
) -> Tour:
    """The fastest tour found that inspects everything that can be, up to `SLACK`. Deterministic.

    Args:
        world: The truth.
        camera: That takes the pictures.
        imaging: What counts as inspected.
        visibility_m: As of the water; None: clear.
        vehicle: For its hull, its speed and its yaw rate; it has no inertia here.
        dt: Control period (s).
    """
    planner = _Planner(world, camera or CameraCfg(), imaging or ImagingCfg(), visibility_m, vehicle or VehicleCfg(), dt)
    poses, seen = planner.candidates()
    cover = greedy_cover(seen, planner.weight)
    target = float(planner.weight[seen.any(axis=0)].sum()) - SLACK if len(poses) else 0.0
    stops = [(float(x), float(y), math.nan) for x, y, _ in poses[cover]]
    order = order_stops(planner.distances(stops))
    route = [stops[k] for k in order]
    route = planner.turn_to_what_is_missed(route, poses, seen, target)
    route = planner.improve(route, target)
    return planner.tour(route, target)


def greedy_cover(seen: NDArray[np.bool_], weight: NDArray[np.float64]) -> list[int]:
    """Few rows that together have all that any row has: always the row that adds most.

    Args:
        seen: Shape=(V, M).
        weight: Shape=(M,), worth of each column.
    """
    left = seen.any(axis=0)
    table, chosen = seen.astype(np.float32), []
    while left.any():
        best = int(np.argmax(table @ np.where(left, weight, 0.0).astype(np.float32)))
        if not (seen[best] & left).any():
            best = int(np.argmax((seen & left).any(axis=1)))
        chosen.append(best)
        left &= ~seen[best]
    return chosen


def order_stops(distance: NDArray[np.float64]) -> list[int]:
    """A short open tour: nearest neighbour, then 2-opt and Or-opt until neither shortens it.

    Args:
        distance: Shape=(N + 1, N), from the start (row 0) and from stop k (row k + 1) to every stop (m).

    Returns:
        The stops in order.
    """
    left, order, at = set(range(distance.shape[1])), list[int](), 0
    while left:
        best = min(left, key=lambda k: (distance[at, k], k))
        left.remove(best)
        order.append(best)
        at = best + 1

    def length(route: Sequence[int]) -> float:
        return float(sum(distance[a, b] for a, b in zip([0, *(k + 1 for k in route)], route, strict=False)))

    better, best_length = True, length(order)
    while better:
        better = False
        for changed in neighbours(order):
            if (found := length(changed)) < best_length - 1e-9:
                order, best_length, better = changed, found, True
                break
    return order


def neighbours(route: Sequence[int]) -> Iterator[list[int]]:
    """Every route with one stretch reversed (2-opt), or up to three stops in a row moved elsewhere (Or-opt)."""
    n = len(route)
    for i, j in itertools.combinations(range(n + 1), 2):
        if j - i >= 2:
            yield [*route[:i], *reversed(route[i:j]), *route[j:]]
    for size, i in itertools.product((1, 2, 3), range(n)):
        rest, part = [*route[:i], *route[i + size :]], route[i : i + size]
        if i + size <= n:
            yield from ([*rest[:k], *part, *rest[k:]] for k in range(len(rest) + 1) if k != i)


class _Planner:
    """What does not change while tours in one world are compared."""

    def __init__(
        self,
        world: ReefWorld,
        camera: CameraCfg,
        imaging: ImagingCfg,
        visibility_m: float | None,
        vehicle: VehicleCfg,
        dt: float,
    ) -> None:
        self.meter = ImagingMeter(Scene.from_world(world), camera, imaging, visibility_m=visibility_m)
        self.start = Pose(world.start.x, world.start.y, world.start.theta)
        self.vehicle, self.dt = vehicle, dt
        self.weight: NDArray[np.float64] = 1.0 / (len(world.clusters) * self.meter.size[self.meter.group])
        """What each point adds to the share. Shape=(M,)."""
        outlines = [obstacle_outline(obstacle) for obstacle in world.obstacles]
        space = free_space(world.size_m, outlines, self.start[:2])
        self._cell_m, self._clearance = space.cell_m, distance_to(space.solid, space.cell_m)
        # Paths keep off obstacles where there is room, since whoever follows one cuts corners by a few centimetres.
        self._paths = CostFieldCfg(radius_m=vehicle.hull_radius_m + 0.05, band_m=0.2, penalty=1.0)
        self._fields: dict[tuple[float, float], CostField] = {}
        self._legs: dict[tuple[float, ...], NDArray[np.float64]] = {}
        self._evaluations = 0

    def candidates(self) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Viewpoints that the hull can get to, Shape=(V, 3), and which points each inspects, Shape=(V, M)."""
        xy, reach = self.meter.points[:, :2], self.meter.inspection_m
        low, high = xy.min(axis=0) - reach, xy.max(axis=0) + reach
        axes = [np.arange(a, b + GRID_M, GRID_M) for a, b in zip(low, high, strict=True)]
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
                    seen.append(level == INSPECTED)
        return np.array(poses).reshape(-1, 3), np.array(seen, np.bool_).reshape(-1, len(xy))

    def distances(self, stops: Sequence[Stop]) -> NDArray[np.float64]:
        """Lengths of the ways (m) from the start and every stop to every stop. Shape=(N + 1, N)."""
        x, y = np.array([self.start[:2], *(stop[:2] for stop in stops)]).T
        columns = [self._field(stop[:2]).lengths(x, y) for stop in stops]
        return np.stack(columns, axis=1) if stops else np.empty((1, 0))

    def turn_to_what_is_missed(
        self, route: list[Stop], poses: NDArray[np.float64], seen: NDArray[np.bool_], target: float
    ) -> list[Stop]:
        """Add stops with a heading until the target is met; each where it costs the least time."""
        while True:
            _, level = self._drive(route, target)
            if float(self.weight[level == INSPECTED].sum()) >= target:
                return route
            gain = seen.astype(np.float32) @ np.where(level == INSPECTED, 0.0, self.weight).astype(np.float32)
            x, y, theta = map(float, poses[int(np.argmax(gain))])
            options = [[*route[:k], (x, y, theta), *route[k:]] for k in range(len(route) + 1)]
            route = min(options, key=self._length)

    def improve(self, route: list[Stop], target: float) -> list[Stop]:
        """Leave out, turn or move stops as long as the tour, as it is driven, gets faster."""
        best, _ = self._drive(route, target)
        better = True
        while better and self._evaluations < EVALUATIONS:
            better = False
            for change in (_without, _unturned, _rearranged):
                for changed in change(route):
                    if change is _rearranged and self._length(changed) > self._length(route) + 2.0:
                        continue
                    if self._evaluations >= EVALUATIONS:
                        break
                    self._evaluations += 1
                    found, _ = self._drive(changed, target)
                    if found < best - 1e-9:
                        route, best, better = changed, found, True
                        break
                if better:
                    break
        return route

    def tour(self, route: Sequence[Stop], target: float) -> Tour:
        """The tour tick by tick, until the target is met."""
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
        """When the target is met (s; inf: never), and the level of every point by then or at the end."""
        _, poses = self._follow(route)
        level, count = self._nothing()
        for k in [*range(0, len(poses), LOOK_PERIOD), len(poses) - 1]:
            self.meter.look(Pose(*poses[k]), level, count)
            if float((count[INSPECTED] / self.meter.size).mean()) >= target:
                return k * self.dt, level
        return math.inf, level

    def _follow(self, route: Sequence[Stop]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Commands and poses of the drive to all stops; where a stop has a heading, it is turned to there."""
        commands, poses = [np.empty((0, 2))], [np.array([self.start])]
        path, at = [np.array([self.start[:2]])], self.start[:2]
        for k, (x, y, theta) in enumerate(route):
            path.append(self._leg(at, (x, y)))
            at = x, y
            if math.isfinite(theta) or k == len(route) - 1:
                self._append(np.concatenate(path), theta, commands, poses)
                path = [np.array([poses[-1][-1, :2]])]
        return np.concatenate(commands), np.concatenate(poses)

    def _append(
        self,
        path: NDArray[np.float64],
        theta: float,
        commands: list[NDArray[np.float64]],
        poses: list[NDArray[np.float64]],
    ) -> None:
        speed, rate, dt = self.vehicle.max_speed_m_s, self.vehicle.max_yaw_rate_rad_s, self.dt
        most = int(4.0 * len(path) * 0.05 / (speed * dt)) + math.ceil(40.0 / dt)
        ordered, driven = np.empty((most, 2)), np.empty((most, 3))
        x, y, heading = (float(v) for v in poses[-1][-1])
        n = follow((x, y, heading), path, speed, rate, dt, most, ordered, driven)
        commands.append(ordered[:n])
        poses.append(driven[:n])
        if not math.isfinite(theta):
            return
        x, y, heading = (float(v) for v in (driven[n - 1] if n else poses[-2][-1]))
        turn = math.remainder(theta - heading, 2.0 * math.pi)
        ticks = math.ceil(abs(turn) / (rate * dt))
        share = np.arange(1, ticks + 1) / max(ticks, 1)
        commands.append(np.stack([np.zeros(ticks), np.full(ticks, turn / max(ticks, 1) / dt)], axis=1))
        poses.append(np.stack([np.full(ticks, x), np.full(ticks, y), heading + turn * share], axis=1))

    def _length(self, route: Sequence[Stop]) -> float:
        places = [self.start[:2], *(stop[:2] for stop in route)]
        return sum(self._field(b).lookup(*a) for a, b in itertools.pairwise(places))

    def _field(self, goal: tuple[float, float]) -> CostField:
        if goal not in self._fields:
            self._fields[goal] = CostField.compute(self._clearance, goal, cell_m=self._cell_m, cfg=self._paths)
        return self._fields[goal]

    def _leg(self, a: tuple[float, float], b: tuple[float, float]) -> NDArray[np.float64]:
        if (*a, *b) not in self._legs:
            self._legs[*a, *b] = self._field(b).path_from(*a, step_m=0.05, length_m=400.0)
        return self._legs[*a, *b]

    def _nothing(self) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        return np.zeros(len(self.meter.points), np.uint8), np.zeros((3, len(self.meter.size)), np.int64)


Route = list[Stop]
Change = Callable[[Route], Iterator[Route]]


def _without(route: Route) -> Iterator[Route]:
    for k in range(len(route)):
        yield [*route[:k], *route[k + 1 :]]


def _unturned(route: Route) -> Iterator[Route]:
    for k, (x, y, theta) in enumerate(route):
        if math.isfinite(theta):
            yield [*route[:k], (x, y, math.nan), *route[k + 1 :]]


def _rearranged(route: Route) -> Iterator[Route]:
    for order in neighbours(range(len(route))):
        yield [route[k] for k in order]
