"""Goals as the composing rules read them: which ones move an object, and their names in messages."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.contact.rules.scene_reading import Thing
from coral.contact.rules.support import other_things, rests_on, top_height
from coral.contact.scene.facts import AtGoal, Goal, GoalsByKind, InsideGoal, RestingGoal, SceneFacts

KEPT = (
    *("undisturbed", "upright", "released", "still"),
    *("peak-force", "speed-limit", "kept-level", "kept-touching", "never-touched"),
)
"""Goals that an untouched object meets: a plan that moves an object releases it as it stood, and the others limit how
it moves. The skills do not plan for these limits."""
BESIDES = {"pointing": "flipped", "slid": "lifted", "sequence": "lifted"}
"""Goals that a skill for another kind of goal meets by the way: on which side a box falls, that a board is pushed."""

FLAT_M = 0.01


class NoRule(ValueError):
    """The rules cannot reach the goals."""


def moves(goal: Goal, facts: SceneFacts) -> bool:
    """Check whether a goal requires its object to be moved."""
    if goal["kind"] == "flipped":
        return goal["degrees"] > goal["tolerance_deg"]
    if goal["kind"] != "inside" and goal["kind"] != "resting":
        return goal["kind"] not in KEPT
    thing = Thing(goal["object"], facts)
    if goal["kind"] == "inside":
        there = (np.asarray(goal["low"]) <= thing.position) & (thing.position <= np.asarray(goal["high"]))
        return not (there.all() and any(rests_on(thing, facts, name) for name in other_things(facts, thing)))
    return not rests_on(thing, facts, goal["thing"])


def movement_goals(asked: Sequence[Goal], facts: SceneFacts) -> list[Goal]:
    """Return those goals of one object that require it to be moved."""
    found = [goal for goal in asked if moves(goal, facts)]
    kinds = {goal["kind"] for goal in found}
    found = [goal for goal in found if BESIDES.get(goal["kind"]) not in kinds]
    if any(goal["kind"] != "resting" for goal in found):
        # An object that is turned, pushed or put down comes to rest on the table or on something flat anyway.
        found = [goal for goal in found if goal["kind"] != "resting" or _top_height(goal["thing"], facts) > FLAT_M]
    return found


def require_different_kinds(goals: Sequence[Goal]) -> None:
    """Check that no two goals of one object are of the same kind.

    Raises:
        NoRule: Two of them are of the same kind.
    """
    found: dict[str, Goal] = {}
    for goal in goals:
        if goal["kind"] in found:
            raise NoRule(
                f"the {goal['object']} is asked two things of one kind, and no rule does {goal_words(goal)} "
                f"besides {goal_words(found[goal['kind']])}"
            )
        found[goal["kind"]] = goal


def _top_height(name: str, facts: SceneFacts) -> float:
    return top_height(facts, name, np.zeros(2), np.inf) or 0.0


def goal_words(goal: Goal) -> str:
    """Return the name of a goal in a message."""
    if goal["kind"] == "at":
        return f"at {goal['place']}"
    if goal["kind"] == "inside":
        return f"inside {list(goal['low'])} to {list(goal['high'])}"
    if goal["kind"] == "resting":
        return f"resting on {goal['thing']}"
    if goal["kind"] == "flipped":
        return f"flipped by {goal['degrees']:g} degrees"
    return f"{goal['kind']} by {goal['thing']}" if goal["kind"] == "touched-while-turning" else goal["kind"]


def require_only(kinds: set[str], moving: Sequence[Goal], name: str, done: str) -> None:
    """Check that one skill reaches all goals that move an object.

    Args:
        kinds: Kinds of goals that the skill reaches.
        moving: The object's goals that require it to be moved, one of each kind.
        name: Name of the object.
        done: What the skill does with it, for the message.

    Raises:
        NoRule: There is a goal of another kind.
    """
    left = sorted((goal for goal in moving if goal["kind"] not in kinds), key=lambda goal: goal["kind"])
    if left:
        raise NoRule(f"the {name} can be {done}, but no rule does besides: {', '.join(map(goal_words, left))}")


def placing_goal(goals: GoalsByKind, moving: Sequence[Goal]) -> AtGoal | InsideGoal | RestingGoal | None:
    """Return the goal that says where to put an object down; None if there is none."""
    kinds = {goal["kind"] for goal in moving}
    if "at" in kinds:
        return goals["at"]
    if "inside" in kinds:
        return goals["inside"]
    return goals["resting"] if "resting" in kinds else None
