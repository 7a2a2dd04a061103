"""Whether the goals of two tasks are of the same kinds, which things correspond, and how far two scenes differ.

The numbers of a scene have names that do not depend on the names of its things.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.scene.facts import SceneFacts
from coral.contact.scene.geometry import rotation_of

Goal = Mapping[str, Any]

IGNORED = frozenset({"undisturbed"})
"""Kinds that say nothing about how to act."""
MANNER = frozenset({"upright", "still", "peak-force", "kept-level", "kept-near"})
"""Kinds that restrict how the others are reached. A plan without them may still do."""
STRICT = frozenset({"never-touched", "kept-touching"})
"""Kinds that, if asked for, must have been asked for when the plan succeeded; otherwise they are no obstacle."""
NAMES = ("object", "thing", "other", "place")
"""Fields that name a thing of the scene."""
SAME_DIRECTION = 0.8
"""Smallest cosine between two directions that count as the same."""
SHORT_M = 0.01
"""An offset shorter than this has no direction."""
ANGLE_DEG = 25.0
"""Largest difference between two angles that count as the same."""
MOST_ORDERS = 24
"""Maximum number of pairings that are tried."""
FITS_HAND_M = MAX_OPENING_M - 0.004
"""Largest extent that the fingers enclose, with 2 mm of room on each side."""
HELD = frozenset({"grasped", "lifted", "inserted", "at-object"})
"""Kinds of goals for which a plan usually grasps the object."""
FIXED_THINGS = frozenset({"table", "hand", "robot"})
MAGNITUDES = ("height_m", "newtons", "distance_m", "depth_m", "speed_m_s")
"""Numbers of goals whose size changes the plan; tolerances and durations do not."""
FACTORS = {"mass_kg": 10.0, "friction": 4.0, **dict.fromkeys(MAGNITUDES, 4.0)}
"""Largest factor between two masses, two frictions, and two of these numbers."""
SIZE_FACTOR = 2.5
"""Largest factor between two extents. A plan is adapted to other sizes, and tried before it is used."""
PLACE_M = 0.5
"""Largest distance between two places, or two fixtures, that the goals name."""


@dataclass(frozen=True)
class GoalMatch:
    """How remembered goals correspond to those asked for."""

    names: Mapping[str, str]
    """Things of the remembered scene and their counterparts here."""
    missing: tuple[str, ...]
    """Kinds of restrictions that are asked for here, and were not when the plan succeeded."""


def match_goals(
    remembered: Sequence[Goal],
    asked: Sequence[Goal],
    then: Mapping[str, float] | None = None,
    now: Mapping[str, float] | None = None,
) -> GoalMatch | None:
    """Match the goals of two tasks by kind, direction and manner, whatever their names, order and magnitudes.

    `then` and `now` are the positions of the joints when the remembered and the present trial began, by object, degrees
    or metres. None if the tasks ask for different things.
    """
    before, after = _flatten(remembered), _flatten(asked)
    defining = [[one for one in goals if one["kind"] not in MANNER | STRICT] for goals in (before, after)]
    if not defining[0] or len(defining[0]) != len(defining[1]):
        return None
    strict = {one["kind"] for one in after} & STRICT
    if strict - {one["kind"] for one in before}:
        return None
    for order in _pairings(*defining):
        names = _pair(order, then or {}, now or {})
        if names is not None and _agree_on_strict(before, after, names):
            missing = {one["kind"] for one in after} & MANNER - {one["kind"] for one in before}
            return GoalMatch(names, tuple(sorted(missing)))
    return None


def _flatten(goals: Sequence[Goal], prefix: str = "") -> list[dict[str, Any]]:
    """Return the goals, those in the events of sequences included, without those that say nothing of how to act."""
    found: list[dict[str, Any]] = []
    for goal in goals:
        kind = str(goal["kind"])
        if kind == "sequence":
            for index, event in enumerate(goal["events"]):
                found += _flatten(event, f"{prefix}{index}.")
        elif kind not in IGNORED:
            found.append({**goal, "kind": prefix + kind})
    return found


def _pairings(first: Sequence[Goal], second: Sequence[Goal]) -> Iterator[list[tuple[Goal, Goal]]]:
    """Yield the ways to pair goals of the same kind, the order in the file first."""
    first = sorted(first, key=lambda goal: str(goal["kind"]))
    second = sorted(second, key=lambda goal: str(goal["kind"]))
    if [goal["kind"] for goal in first] != [goal["kind"] for goal in second]:
        return
    groups = [list(group) for _, group in itertools.groupby(second, key=lambda goal: str(goal["kind"]))]
    orders = itertools.product(*(itertools.permutations(group) for group in groups))
    for order in itertools.islice(orders, MOST_ORDERS):
        yield list(zip(first, itertools.chain(*order), strict=True))


def _pair(
    pairs: Sequence[tuple[Goal, Goal]], then: Mapping[str, float], now: Mapping[str, float]
) -> dict[str, str] | None:
    """Return the names that correspond if each pair asks for the same; None otherwise."""
    names: dict[str, str] = {}
    for one, other in pairs:
        for key in NAMES:
            a, b = one.get(key), other.get(key)
            if a is None and b is None:
                continue
            if a is None or b is None or (a == "table") != (b == "table") or names.setdefault(a, b) != b:
                return None
        if not _same(one, other) or _way(one, then) != _way(other, now):
            return None
    return names if len(set(names.values())) == len(names) else None


def _same(one: Goal, other: Goal) -> bool:
    """Check that two goals of one kind differ at most in magnitudes."""
    for key in (set(one) | set(other)) - {*NAMES, "kind"}:
        a, b = one.get(key), other.get(key)
        if isinstance(a, str | bool) or isinstance(b, str | bool):
            if a != b:
                return False
        elif key in ("direction", "offset"):
            if not _same_direction(a or (0, 0, 0), b or (0, 0, 0)):
                return False
        elif key == "degrees" and abs(float(one[key]) - float(other[key])) > ANGLE_DEG:
            return False
    return True


def _same_direction(a: Sequence[float], b: Sequence[float]) -> bool:
    lengths = [math.hypot(*v) for v in (a, b)]
    if min(lengths) < SHORT_M:
        return max(lengths) < SHORT_M
    return sum(x * y for x, y in zip(a, b, strict=True)) >= SAME_DIRECTION * lengths[0] * lengths[1]


def _way(goal: Goal, joints: Mapping[str, float]) -> int:
    """Return whether a joint is to be moved up (1) or down (-1) its range; 0 where there is none to move."""
    band = goal.get("between_deg") or goal.get("between_m")
    if not str(goal["kind"]).endswith("opened") or band is None or goal["object"] not in joints:
        return 0
    at = joints[goal["object"]]
    return 1 if at < band[0] else -1 if at > band[1] else 0


def _agree_on_strict(before: Sequence[Goal], after: Sequence[Goal], names: Mapping[str, str]) -> bool:
    """Check that what must (not) be touched here is what must (not) be touched in the remembered task."""
    known = {
        (one["kind"], names.get(one["object"], one["object"]), names.get(one.get("thing", ""), one.get("thing")))
        for one in before
        if one["kind"] in STRICT
    }
    return all((one["kind"], one["object"], one.get("thing")) in known for one in after if one["kind"] in STRICT)


def scene_numbers(facts: SceneFacts) -> dict[str, float]:
    """Return the numbers of a scene by name; things are numbered in the order in which the goals name them.

    For thing k: `objectk.size.0` to `.2` (m), `.up` (its axis nearest to vertical), `.mass_kg`, `.friction`, `.joint`;
    `place.NAME.0` to `.2` (m) of places and fixtures; `goal.KIND.objectk.FIELD`.
    """
    found: dict[str, float] = {}
    order = {name: f"object{index}" for index, name in enumerate(roles(facts["goals"]))}
    for name, key in order.items():
        item: Mapping[str, Any] = facts["objects"].get(name) or facts["fixtures"].get(name) or {}
        found |= {f"{key}.size.{k}": float(value) for k, value in enumerate(item.get("size_m", ()))}
        found |= {f"{key}.{name}": float(item[name]) for name in ("mass_kg", "friction") if name in item}
        if "pose" in item:
            found[f"{key}.up"] = float(np.argmax(np.abs(rotation_of(np.asarray(item["pose"][3:]))[2])))
        if "joint" in item:
            found[f"{key}.joint"] = float(item["joint"]["now"])
    for goal in facts["goals"]:
        for field in MAGNITUDES:
            if goal.get(field) is not None:
                key = f"goal.{goal['kind']}.{order.get(goal['object'], goal['object'])}.{field}"
                found.setdefault(key, float(goal[field]))
    fixed = {name: item["position"] for name, item in facts["fixtures"].items()}
    for name, place in {**fixed, **facts["places"]}.items():
        found |= {f"place.{name}.{k}": float(value) for k, value in enumerate(place)}
    return found


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
        factor = SIZE_FACTOR if ".size." in key else FACTORS.get(field)
        if key.startswith("place."):
            worst = max(worst, abs(a - b) / PLACE_M if key.split(".")[1] in places else 0.0)
        elif field == "up":
            worst = max(worst, 0.0 if a == b else math.inf)
        elif factor is not None and a != b:
            worst = max(worst, abs(math.log(a / b)) / math.log(factor) if a > 0 and b > 0 else math.inf)
    return worst


def fits_hand(numbers: Mapping[str, float], key: str) -> bool:
    """Check whether the fingers can close from above around a thing as it stands: `key` is `object0` and so on."""
    up = int(numbers.get(f"{key}.up", 2))
    return any(numbers.get(f"{key}.size.{k}", math.inf) <= FITS_HAND_M for k in range(3) if k != up)
