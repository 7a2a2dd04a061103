"""Support of an object: the heights of fixtures, objects and the table at and around a point."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from coral.contact.rules.scene_reading import Array, Thing
from coral.contact.scene.facts import SceneFacts, on_table


def blocks(facts: SceneFacts, name: str) -> Iterator[tuple[Array, Array, Array, float]]:
    """Return the parts of a fixture or object as upright boxes.

    Yields:
        Middle, Shape=(2,) m; two unit directions, the rows of Shape=(2, 2); half extents along them, Shape=(2,) m;
        height of the top, m.
    """
    if name in facts["fixtures"]:
        item = facts["fixtures"][name]
        yaw = np.radians(item["yaw_deg"])
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        middle, half = np.asarray(item["position"], dtype=float), np.asarray(item["size_m"], dtype=float) / 2
        yield middle[:2], turn, half[:2], float(middle[2] + half[2])
        return
    thing = Thing(name, facts)
    for middle, half in thing.parts:
        at = thing.position + thing.rotation @ middle
        ways = thing.rotation[:2, thing.lying].T
        yield at[:2], ways / np.linalg.norm(ways, axis=1)[:, None], half[thing.lying], float(at[2] + half[thing.up])


def top_height(facts: SceneFacts, name: str, point: Array, within_m: float = 0.0) -> float | None:
    """Return the height (m) of the highest part of a fixture, object or table at a point or within a radius; else None.

    Args:
        facts: The scene.
        name: Name of the fixture, object or table.
        point: Shape=(2,), x and y in m.
        within_m: Radius around the point.
    """
    if name == "table":
        return 0.0 if on_table(facts["table"], point) else None
    found = [
        height
        for middle, ways, half, height in blocks(facts, name)
        if np.linalg.norm(np.maximum(np.abs(ways @ (point - middle)) - half, 0.0)) <= within_m
    ]
    return max(found, default=None)


def other_things(facts: SceneFacts, thing: Thing) -> list[str]:
    """Return the names of all things but one object."""
    return ["table", *facts["fixtures"], *(name for name in facts["objects"] if name != thing.name)]


def origin_height(thing: Thing) -> float:
    """Compute the height (m) of the origin of an object's frame above its lowest point, in its present orientation."""
    return float(thing.position[2] - thing.low)


def rests_on(thing: Thing, facts: SceneFacts, name: str) -> bool:
    """Check whether an object rests on something, within a centimetre because poses are tracked."""
    height = top_height(facts, name, thing.position[:2])
    return height is not None and abs(thing.low - height) < 0.01
