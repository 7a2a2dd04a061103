"""Goals as the composing rules read them: which ask for something to be moved, and how each is called."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coral.contact.rules.scene_reading import Thing
from coral.contact.rules.support import rests_on, things_around, top_height

KEPT = ("undisturbed", "upright", "released")
"""What holds of what is left alone; a plan that moves an object lets go of it and keeps it as it stood anyway."""

FLAT_M = 0.01


class NoRule(ValueError):
    """The rules know no way to what is asked."""


def moves(goal: Mapping[str, Any], facts: Mapping[str, Any]) -> bool:
    """Whether a goal asks for its object to be moved."""
    kind = goal["kind"]
    if kind == "flipped":
        return bool(goal["degrees"] > goal["tolerance_deg"])
    if kind not in ("inside", "resting"):
        return kind not in KEPT
    thing = Thing(goal["object"], facts)
    if kind == "inside":
        there = (np.asarray(goal["low"]) <= thing.position) & (thing.position <= np.asarray(goal["high"]))
        return not (there.all() and any(rests_on(thing, facts, name) for name in things_around(facts, thing)))
    return not rests_on(thing, facts, goal["thing"])


def movement_goals(asked: Sequence[Mapping[str, Any]], facts: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Of the goals of one object, those that ask for it to be moved."""
    found = [goal for goal in asked if moves(goal, facts)]
    if any(goal["kind"] != "resting" for goal in found):
        # Whatever is turned, pushed or put down comes to rest on the table, or on what is as flat as a mat.
        found = [goal for goal in found if goal["kind"] != "resting" or _top(goal["thing"], facts) > FLAT_M]
    return found


def merged_goals(goals: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """Goals of one object by their kind.

    Raises:
        NoRule: Two of them are of one kind.
    """
    found: dict[str, Mapping[str, Any]] = {}
    for goal in goals:
        if goal["kind"] in found:
            raise NoRule(
                f"the {goal['object']} is asked two things of one kind, and no rule does {goal_words(goal)} "
                f"besides {goal_words(found[goal['kind']])}"
            )
        found[goal["kind"]] = goal
    return found


def _top(name: str, facts: Mapping[str, Any]) -> float:
    return top_height(facts, name, np.zeros(2), np.inf) or 0.0


def goal_words(goal: Mapping[str, Any]) -> str:
    """A goal as a message names it."""
    kind = str(goal["kind"])
    if kind == "at":
        return f"at {goal['place']}"
    if kind == "inside":
        return f"inside {list(goal['low'])} to {list(goal['high'])}"
    if kind == "resting":
        return f"resting on {goal['thing']}"
    if kind == "flipped":
        return f"flipped by {goal['degrees']:g} degrees"
    return f"{kind} by {goal['thing']}" if kind == "touched-while-turning" else kind


def served(goals: Mapping[str, Any], asked: set[str], by: set[str], name: str, done: str) -> None:
    """See that nothing is asked of an object beside what one way serves.

    Args:
        goals: Its goals by kind.
        asked: Kinds that ask for it to be moved.
        by: Kinds that the way serves.
        name: The object.
        done: What the way does with it.

    Raises:
        NoRule: There is something else.
    """
    left = sorted(asked - by)
    if left:
        raise NoRule(
            f"the {name} can be {done}, but no rule does besides: {', '.join(goal_words(goals[kind]) for kind in left)}"
        )
