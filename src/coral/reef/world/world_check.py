"""Checks of a world beyond its types: objects outside, a start inside a rock, an unreachable cluster."""

from __future__ import annotations

import math

from coral.errors import InputError
from coral.reef.world.reachability import HULL_RADIUS_M, VIEW_M, distance_to, obstacle_outline, unreachable_clusters
from coral.reef.world.world_model import ReefWorld

MIN_EDGE_M, MAX_EDGE_M = 2.0, 100.0
"""Smallest and largest edge of a world: a small pool, and the limit of a map with 5 cm cells."""
MAX_OBJECTS = 20_000
HIGHEST_OYSTER_M = 2.0
"""Largest height of an oyster above the seabed: oysters also settle on rocks and posts."""


def check_world(world: ReefWorld, where: str) -> None:
    """Check a world and report its first fault.

    Raises:
        InputError: The size or the number of objects is out of range; an object or the start lies outside; the start
            is closer to an obstacle than the hull's radius; two clusters share a name; a hull of 0.3 m radius cannot
            get within 2 m of some cluster, in line of sight. An obstacle of any height counts.
    """
    _check_size(world, where)
    _check_places(world, where)
    start = world.start
    for i, obstacle in enumerate(world.solids):
        gap = distance_to(obstacle_outline(obstacle), start.x, start.y)
        if gap < HULL_RADIUS_M:
            what = f"obstacles[{i}]" if i < len(world.obstacles) else "a wall, the tank or an anchor"
            found = f"({start.x:g}, {start.y:g}), {'inside' if gap < 0 else f'{gap:.2f} m from'} {what}"
            raise InputError(where, "start", found, f"a place at least {HULL_RADIUS_M:g} m from every obstacle")
    for i in unreachable_clusters(world):
        raise InputError(
            where,
            f"clusters[{i}]",
            f"cluster {world.clusters[i].name!r} out of the robot's reach",
            f"a passage wider than {2 * HULL_RADIUS_M:g} m from the start to within {VIEW_M:g} m of it",
        )


def _check_size(world: ReefWorld, where: str) -> None:
    for i, edge in enumerate(world.size_m):
        if not MIN_EDGE_M <= edge <= MAX_EDGE_M:
            raise InputError(where, f"size_m[{i}]", f"{edge:g}", f"between {MIN_EDGE_M:g} and {MAX_EDGE_M:g} m")
    if not world.clusters and not world.things:
        raise InputError(where, "clusters", "none", "at least 1, or things")
    groups = (*world.clusters, *world.alike, *world.lying)
    count = len(world.obstacles) + sum(len(group.oysters) for group in groups)
    if count > MAX_OBJECTS:
        raise InputError(where, "", f"{count} oysters and obstacles", f"at most {MAX_OBJECTS}")
    for part, named in (("clusters", world.clusters), ("things", world.things)):
        names = [one.name for one in named]
        for i, name in enumerate(names):
            if name in names[:i]:
                found = f"{name!r}, as {part}[{names.index(name)}]"
                raise InputError(where, f"{part}[{i}].name", found, "a different name for each")


def _check_places(world: ReefWorld, where: str) -> None:
    _inside(world, where, "start", world.start.x, world.start.y)
    floor = world.seabed.z_m
    for i, cluster in enumerate((*world.clusters, *world.alike, *world.lying)):
        for j, oyster in enumerate(cluster.oysters):
            field = f"clusters[{i}].oysters[{j}]" if cluster.kind is None else f"the thing {cluster.name!r}"
            _inside(world, where, field, oyster.x, oyster.y)
            if not floor - max(oyster.radii) < oyster.z <= floor + HIGHEST_OYSTER_M:
                raise InputError(
                    where,
                    f"{field}.z",
                    f"{oyster.z:g}",
                    f"a height on the seabed, {floor:g} to {floor + HIGHEST_OYSTER_M:g} m",
                )
    for i, obstacle in enumerate(world.obstacles):
        _inside(world, where, f"obstacles[{i}]", obstacle.x, obstacle.y)
        if obstacle.z + obstacle.size[2] <= floor:
            raise InputError(
                where, f"obstacles[{i}].z", f"{obstacle.z:g}, all of it below the seabed", f"a top above {floor:g} m"
            )
        if obstacle.tether is not None and obstacle.z - obstacle.size[2] <= floor:
            raise InputError(
                where,
                f"obstacles[{i}].tether",
                f"a tether of an obstacle that reaches down to {obstacle.z - obstacle.size[2]:g} m",
                f"an obstacle that floats, all of it above {floor:g} m",
            )
    for i, wall in enumerate(world.walls):
        for end, at in (("begin", wall.begin), ("end", wall.end)):
            _inside(world, where, f"walls[{i}].{end}", *at)
    if (tank := world.tank) is not None:
        for axis, value, edge in (("x", tank.x, world.size_m[0]), ("y", tank.y, world.size_m[1])):
            if not tank.radius_m <= value <= edge - tank.radius_m:
                raise InputError(
                    where,
                    f"tank.{axis}",
                    f"{value:g} with a radius of {tank.radius_m:g} m",
                    f"a tank inside the world, 0 to {edge:g} m",
                )
        if not math.dist((tank.x, tank.y), (world.start.x, world.start.y)) < tank.radius_m:
            raise InputError(where, "start", f"({world.start.x:g}, {world.start.y:g})", "a place inside the tank")


def _inside(world: ReefWorld, where: str, field: str, x: float, y: float) -> None:
    for axis, value, edge in (("x", x, world.size_m[0]), ("y", y, world.size_m[1])):
        if not (math.isfinite(value) and 0 <= value <= edge):
            raise InputError(where, f"{field}.{axis}", f"{value:g}", f"a place inside the world, 0 to {edge:g} m")
