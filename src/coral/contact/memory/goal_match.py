"""Whether the goals of two tasks are of the same kinds, and which things correspond."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

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
