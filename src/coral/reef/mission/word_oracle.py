"""The way of an oracle that knows kinds and conditions of a mission in words: a reference, no decision of a robot."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.map.costfield import CostField
from coral.reef.mission.tour import drive_lines
from coral.reef.vehicle.vehicle import VehicleCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.instruction import Answered, EndsAt, InOrder, Inspected, KeptOff, Sides
from coral.reef.world.kinds import find_kind
from coral.reef.world.world import ReefWorld

CELL_M = 0.2
SPARE_M, SPARE_COST = 2.4, 40.0
"""Ways keep this far from what is not wanted, where they can."""
POST_M = 0.8
RING_M, FACE_M = 4.6, 3.4
"""A side is photographed on the way from here to there."""

Point = tuple[float, float]


def word_tour(world: ReefWorld, vehicle: VehicleCfg, dt: float) -> NDArray[np.float64]:
    """Plan the commands of the oracle for a world with a mission. Shape=(K, 2)."""
    start = (world.start.x, world.start.y)
    targets, wanted, fixed = _targets(world, start)
    way: list[Point] = [start]
    for k, target in enumerate(targets):
        slowness = _slowness(world, set(wanted[: k + 1]) if fixed else set(wanted))
        path = CostField.over(slowness, target, cell_m=CELL_M).path_from(*way[-1], step_m=0.4)
        way += [(float(x), float(y)) for x, y in path[1:]]
        if math.dist(way[-1], target) > 0.05:
            way.append(target)
    return drive_lines(np.array(way), Pose(*start, world.start.theta), vehicle, dt)


def true_answer(world: ReefWorld) -> str:
    """Return the right answer to what a mission asks; empty if it asks for nothing."""
    assert world.mission is not None
    return next((one.right[0] for one in world.mission.conditions if isinstance(one, Answered)), "")


def _wanted(world: ReefWorld) -> tuple[list[str], bool, str, str]:
    """Return what is to be inspected, whether in that order, what from several sides, and where the end is, by name."""
    assert world.mission is not None

    def named(of: tuple[str, ...]) -> list[str]:
        return [thing.name for thing in world.things if thing.kind in of or thing.name in of]

    visits: list[str] = []
    fixed, ring, end = False, "", ""
    for one in world.mission.conditions:
        match one:
            case Inspected():
                visits += named(one.of)
            case InOrder():
                visits, fixed = [named((each,))[0] for each in one.of], True
            case Sides():
                ring = named(one.of)[0]
            case EndsAt():
                end = "start" if one.at == "start" else named((one.at,))[0]
            case _:
                pass
    return visits, fixed, ring, end


def _targets(world: ReefWorld, start: Point) -> tuple[list[Point], list[str], bool]:
    """Return the places to go to, in order, what is to be inspected, by name, and whether in that order."""
    at = {"start": start} | {thing.name: (thing.x, thing.y) for thing in world.things}
    visits, fixed, ring, end = _wanted(world)
    last = [at[end]] if end else []
    if not fixed:
        orders = itertools.permutations(visits)
        visits = list(min(orders, key=lambda o: _length([start, *(at[n] for n in o), *last])))
    targets = [at[name] for name in visits]
    if ring:
        x, y = at[ring]
        first = math.atan2(start[1] - y, start[0] - x)
        for angle in (first, first + 1.3, first - 1.3):
            targets += [(x + r * math.cos(angle), y + r * math.sin(angle)) for r in (RING_M, FACE_M)]
    return [*targets, *last], visits, fixed


def _length(way: list[Point]) -> float:
    return sum(math.dist(a, b) for a, b in itertools.pairwise(way))


def _slowness(world: ReefWorld, wanted: set[str]) -> NDArray[np.float32]:
    """Return the cost of water about things that are not wanted and about posts. Shape=(H, W)."""
    assert world.mission is not None
    rows, columns = (math.ceil(world.size_m[k] / CELL_M) for k in (1, 0))
    ys, xs = (np.indices((rows, columns)) + 0.5) * CELL_M
    cost = np.ones((rows, columns), np.float32)
    off = {name for one in world.mission.conditions if isinstance(one, KeptOff) for name in one.of}
    for thing in world.things:
        if thing.name not in wanted and find_kind(thing.kind).class_ != "floor":
            more = 0.6 if {thing.name, thing.kind} & off else 0.0
            cost += SPARE_COST * (np.hypot(xs - thing.x, ys - thing.y) < SPARE_M + more)
    for post in world.obstacles:
        cost[np.hypot(xs - post.x, ys - post.y) < POST_M] = -1.0
    return cost
