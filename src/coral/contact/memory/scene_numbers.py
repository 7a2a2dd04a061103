"""The numbers of a scene under names that do not depend on the names of its things, and how far two scenes differ."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.geometry import rotation_of

FITS_HAND_M = MAX_OPENING_M - 0.004
"""Largest extent that the fingers enclose, with 2 mm of room on each side."""
HELD = frozenset({"grasped", "lifted", "inserted", "at-object"})
"""Kinds of goals for which a plan usually grasps the object."""
FIXED_THINGS = frozenset({"table", "hand", "robot"})
MAGNITUDES = frozenset({"height_m", "newtons", "distance_m", "depth_m", "speed_m_s"})
"""Numbers of goals whose size changes the plan; tolerances and durations do not."""


SIZE_FACTOR = 2.5
"""Largest factor between two extents. A plan is adapted to other sizes, and tried before it is used."""
MASS_FACTOR = 10.0
"""Largest factor between two masses."""
FRICTION_FACTOR = 4.0
"""Largest factor between two frictions."""
NUMBER_FACTOR = 4.0
"""Largest factor between two heights, distances, depths, forces or speeds of the goals."""
PLACE_M = 0.5
"""Largest distance between two places, or two fixtures, that the goals name."""


def scene_numbers(facts: SceneFacts) -> dict[str, float]:
    """Return the numbers of a scene by name; things are numbered in the order in which the goals name them.

    For thing k: `objectk.size.0` to `.2` (m), `.up` (its axis nearest to vertical), `.z` (m), `.mass_kg`, `.friction`,
    `.joint`; `place.NAME.0` to `.2` (m) of places and fixtures, and `place.NAME.low.0` and `.high.0` for the faces of a
    fixture that is not turned; `goal.KIND.objectk.FIELD`; `number.NAME` of the task.
    """
    found: dict[str, float] = {}
    order = {name: f"object{index}" for index, name in enumerate(roles(facts["goals"]))}
    for name, key in order.items():
        item = facts["objects"].get(name)
        if item is not None:
            rotation = rotation_of(np.asarray(item["pose"][3:]))
            found |= {f"{key}.size.{k}": float(value) for k, value in enumerate(item["size_m"])}
            found[f"{key}.up"] = float(np.argmax(np.abs(rotation[2])))
            found[f"{key}.z"] = float(item["pose"][2])
            found |= {f"{key}.{name}": float(item[name]) for name in ("mass_kg", "friction") if name in item}
            if "joint" in item:
                found[f"{key}.joint"] = float(item["joint"]["now"])
        elif name in facts["fixtures"]:
            found |= {f"{key}.size.{k}": float(value) for k, value in enumerate(facts["fixtures"][name]["size_m"])}
    for goal in facts["goals"]:
        for field, value in _magnitudes(goal):
            found.setdefault(f"goal.{goal['kind']}.{order.get(goal['object'], goal['object'])}.{field}", value)
    found |= {f"number.{key}": float(value) for key, value in facts["numbers"].items()}
    for name, fixture in facts["fixtures"].items():
        for k, (middle, size) in enumerate(zip(fixture["position"], fixture["size_m"], strict=True)):
            found[f"place.{name}.{k}"] = float(middle)
            found[f"place.{name}.low.{k}"] = round(middle - size / 2, 5)
            found[f"place.{name}.high.{k}"] = round(middle + size / 2, 5)
    for name, place in facts["places"].items():
        found |= {f"place.{name}.{k}": float(value) for k, value in enumerate(place)}
    return found


def _magnitudes(goal: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    for field, value in goal.items():
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield field, float(value)


def roles(goals: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the things that the goals name, in their order; not those that are only to be left alone."""
    found: dict[str, None] = {}
    for goal in goals:
        if goal["kind"] == "undisturbed":
            continue
        named = [goal["object"], goal.get("other"), goal.get("thing")]
        for event in goal.get("events", ()):
            named += roles(event)
        found |= {name: None for name in named if name is not None and name not in FIXED_THINGS}
    return list(found)


def joints_of(numbers: Mapping[str, float], goals: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Return the positions of the joints in a scene's numbers by the names of their objects."""
    keys = {name: f"object{index}.joint" for index, name in enumerate(roles(goals))}
    return {name: numbers[key] for name, key in keys.items() if key in numbers}


def translate_numbers(
    numbers: Mapping[str, float],
    before: Sequence[Mapping[str, Any]],
    after: Sequence[Mapping[str, Any]],
    names: Mapping[str, str],
) -> dict[str, float]:
    """Return the numbers of a remembered scene under the names that their counterparts have in this scene.

    `before` are its goals, `after` those here; `names` are things there and their counterparts here.
    """
    here = {name: f"object{index}" for index, name in enumerate(roles(after))}
    keys = {f"object{index}": here[names[name]] for index, name in enumerate(roles(before)) if names.get(name) in here}

    def renamed(key: str) -> str:
        parts = key.split(".")
        kind = parts[0]
        at = {"place": 1, "goal": 2}.get(kind, 0)
        parts[at] = (names if kind == "place" else keys).get(parts[at], parts[at])
        return ".".join(parts)

    return {renamed(key): value for key, value in numbers.items()}


def scene_distance(one: Mapping[str, float], other: Mapping[str, float], places: frozenset[str]) -> float:
    """Compute the largest difference between two scenes, relative to its limit; infinite if it cannot be overcome.

    Both have this scene's names. Only the places and fixtures that the goals name, `places`, matter.
    """
    worst = 0.0
    for key in set(one) & set(other):
        a, b, field = one[key], other[key], key.rsplit(".", 1)[-1]
        if key.startswith("place."):
            worst = max(worst, abs(a - b) / PLACE_M if key.split(".")[1] in places else 0.0)
        elif field == "up":
            worst = max(worst, 0.0 if a == b else math.inf)
        else:
            factor = _limit(key, field)
            if factor is None or a == b:
                continue
            worst = max(worst, abs(math.log(a / b)) / math.log(factor) if a > 0 and b > 0 else math.inf)
    return worst


def _limit(key: str, field: str) -> float | None:
    if ".size." in key:
        return SIZE_FACTOR
    if key.startswith("goal."):
        return NUMBER_FACTOR if field in MAGNITUDES else None
    return {"mass_kg": MASS_FACTOR, "friction": FRICTION_FACTOR}.get(field)


def fits_hand(numbers: Mapping[str, float], key: str) -> bool:
    """Check whether the fingers can close from above around a thing as it stands: `key` is `object0` and so on."""
    up = int(numbers.get(f"{key}.up", 2))
    return any(numbers.get(f"{key}.size.{k}", math.inf) <= FITS_HAND_M for k in range(3) if k != up)
