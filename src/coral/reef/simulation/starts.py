"""Start poses of a fleet: near the first robot, in open water."""

from __future__ import annotations

import itertools
import math

from coral.errors import InputError
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Footprints

APART_M = 1.2
"""Smallest distance between the centres of two robots: twice the hull's diameter."""
TURNS_DEG = (90.0, -90.0, 180.0, 135.0, -135.0, 45.0, -45.0)
"""Directions to try, relative to the first robot's heading: beside it, behind it, then ahead."""
RINGS_M = (APART_M, 1.5, 1.8, 2.4, 3.0, 3.6)


def starts_beside(
    first: Pose, count: int, footprints: Footprints, size_m: tuple[float, float], radius_m: float
) -> list[Pose]:
    """Return the start poses of `count` robots, the first one included. All have its heading.

    Each has a free line of sight to the first, lies at least `APART_M` from every other, and its hull is a radius clear
    of obstacles and the border. The same world gives the same poses.

    Raises:
        InputError: There is no room for this many robots.
    """

    def free(x: float, y: float, room_m: float) -> bool:
        inside = min(x, y, size_m[0] - x, size_m[1] - y) >= room_m
        return inside and clearance(footprints, x, y) >= room_m

    def in_sight(x: float, y: float) -> bool:
        way = math.dist((x, y), first[:2])
        steps = [k / math.ceil(way / 0.1) for k in range(1, math.ceil(way / 0.1))]
        return all(free(first.x + s * (x - first.x), first.y + s * (y - first.y), radius_m) for s in steps)

    placed = [first]
    for ring, turn in itertools.product(RINGS_M, TURNS_DEG):
        if len(placed) == count:
            break
        angle = first.theta + math.radians(turn)
        x, y = first.x + ring * math.cos(angle), first.y + ring * math.sin(angle)
        apart = all(math.dist((x, y), p[:2]) >= APART_M - 1e-9 for p in placed)
        if apart and free(x, y, 2.0 * radius_m) and in_sight(x, y):
            placed.append(Pose(x, y, first.theta))
    if len(placed) < count:
        raise InputError(
            "--robots", "", count, f"at most {len(placed)}: there is no more room beside the start of this world"
        )
    return placed
