"""Where to set down the held object: at a place of the task, inside a region, on top of something."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from coral.contact.rules.goals import NoRule, goal_words
from coral.contact.rules.scene_reading import Array, Thing, vector
from coral.contact.rules.support import origin_height, other_things, top_height
from coral.contact.scene.facts import AtGoal, Goal, InsideGoal, RestingGoal, SceneFacts

HAND_M = 0.11
"""Half the width of the hand: things within this distance of the placement may be under the palm."""
CLEAR_M = 0.01
HIGHEST_M = 0.4
"""Highest top over which the hand carries anything; higher up its workspace and the arm's end."""


@dataclass(frozen=True, kw_only=True)
class Placement:
    """Where and how to set down an object."""

    where: str
    """Its position as program text."""
    height_m: float
    """Height of the object's origin when set down."""
    near_m: float
    """Horizontal distance to the position within which lowering begins."""
    words: str
    """Description of the placement."""
    shift: Array = field(default_factory=lambda: np.zeros(3))
    """Shape=(3,) m, from the object's origin to what is to be there, in the world."""
    top_m: float = 0.0
    """Height of what the object is carried over, besides the things on the table."""
    palm_m: float = 0.0
    """Lowest height of the palm; from there the object is dropped."""


def placement_of(thing: Thing, facts: SceneFacts, goal: AtGoal | InsideGoal | RestingGoal) -> Placement:
    """Find where to set down an object for a goal.

    Raises:
        NoRule: There is no place where the object could come to rest.
    """
    if goal["kind"] == "at":
        return _at_place(thing, facts, goal)
    return _in_region(thing, facts, goal) if goal["kind"] == "inside" else _on_top(thing, facts, goal)


def _at_place(thing: Thing, facts: SceneFacts, goal: AtGoal) -> Placement:
    place, point = np.asarray(facts["places"][goal["place"]], dtype=float), goal.get("point")
    return Placement(
        where=f"self.{goal['place']}_pos",
        near_m=min(0.02, 0.5 * goal["tolerance_m"]),
        height_m=float(place[2] + thing.height / 2 if "z" not in goal.get("axes", "xy") else place[2]),
        shift=np.zeros(3) if point is None else np.asarray(thing.rotation @ thing.points[point]),
        words=f"to {goal['place']} and set it down",
    )


def _in_region(thing: Thing, facts: SceneFacts, goal: InsideGoal) -> Placement:
    low, high = np.asarray(goal["low"], dtype=float), np.asarray(goal["high"], dtype=float)
    sharing = [
        one["object"]
        for one in facts["goals"]
        if one["kind"] == "inside" and one["low"] == goal["low"] and one["high"] == goal["high"]
    ]
    along = int(np.argmax((high - low)[:2]))
    middle = (low + high) / 2
    # Objects that share a region are placed side by side.
    middle[along] = low[along] + (high - low)[along] * (sharing.index(thing.name) + 0.5) / len(sharing)
    tops = [top_height(facts, name, middle[:2]) for name in other_things(facts, thing)]
    floor = max((height for height in tops if height is not None and height < high[2]), default=None)
    if floor is None:
        raise NoRule(f"nothing is there for the {thing.name} to lie on: {goal_words(goal)}")
    height = floor + origin_height(thing)
    if not low[2] <= height <= high[2]:
        raise NoRule(f"let go there, the {thing.name} comes to rest at a height of {height:.3f} m: {goal_words(goal)}")
    over, palm = _heights_to_clear(thing, facts, middle[:2], floor)
    _require_low_enough(thing, over, goal)
    return Placement(
        where=vector([*middle[:2], floor]),
        height_m=height,
        top_m=over,
        palm_m=palm,
        near_m=min(0.02, 0.25 * float((high - low)[:2].min()) / len(sharing)),
        words="into the region and let go",
    )


def _on_top(thing: Thing, facts: SceneFacts, goal: RestingGoal) -> Placement:
    name = goal["thing"]
    if name == "table":
        raise NoRule(f"no goal says where on the table the {thing.name} is to be put: {goal_words(goal)}")
    if name in facts["fixtures"]:
        item = facts["fixtures"][name]
        at, extent, where = np.asarray(item["position"], dtype=float), min(item["size_m"][:2]), ""
    else:
        other = Thing(name, facts)
        at, extent = other.position + other.rotation @ other.middle, float(min(other.size[other.lying]))
        where = f"(self.{name}_pos + {vector(at - other.position)})"
    floor = top_height(facts, name, at[:2])
    if floor is None:
        raise NoRule(f"the {name} has no top in its middle to put the {thing.name} on: {goal_words(goal)}")
    over, palm = _heights_to_clear(thing, facts, at[:2], floor)
    _require_low_enough(thing, over, goal)
    return Placement(
        where=where or vector([*at[:2], floor]),
        height_m=floor + origin_height(thing),
        top_m=over,
        palm_m=palm,
        near_m=min(0.02, 0.2 * float(extent)),
        words=f"over the {name} and set it down",
    )


def _heights_to_clear(thing: Thing, facts: SceneFacts, point: Array, floor: float) -> tuple[float, float]:
    """Compute the highest top near the placement, and the lowest height that the palm may reach there (m)."""
    near = [top_height(facts, name, point, HAND_M) for name in other_things(facts, thing)]
    over = max([floor, *(height for height in near if height is not None)])
    return over, over + CLEAR_M if over > floor else 0.0


def _require_low_enough(thing: Thing, over: float, goal: Goal) -> None:
    if over > HIGHEST_M:
        raise NoRule(f"the {thing.name} would have to be carried over a height of {over:.2f} m: {goal_words(goal)}")
