"""The default advisor's cost without a contact strategy: it rates the goals, but not where to touch the objects.

The paper's ablation leaves the search for useful contacts to the sampling. Its cost functions read contact points that
only a strategy provides, and fall back on the object's position. This one does the same: it attracts the hand to the
object.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.rules.goals import movement_goals
from coral.contact.rules.scene_reading import Thing, axis_of, number, vector
from coral.contact.rules.support import origin_height, top_height
from coral.contact.scene.facts import AtGoal, FlippedGoal, Goal, InsideGoal, LiftedGoal, RestingGoal, SceneFacts

MARGIN_M = 0.02
"""The hand is attracted until it is this far beyond an object's largest half extent; within, it may touch anywhere."""
DONE = 0.7
"""An object's goals count as met if their terms add up to less: a flip within 6 degrees, a place within 4 cm."""
EDGE_M = 0.02
"""Distance inside a region's bounds to which an object is attracted."""


def outcome_plan(facts: SceneFacts) -> PlanAnswer | None:
    """Compose one cost for the whole task from its goals alone; None if no goal can be expressed as a cost."""
    terms: list[str] = []
    trial: list[str] = []
    moving = [
        goal
        for name in dict.fromkeys(goal["object"] for goal in facts["goals"])
        for goal in movement_goals([one for one in facts["goals"] if one["object"] == name], facts)
    ]
    for goal in facts["goals"]:
        name, term = goal["object"], _term(goal)
        if term is not None:
            terms.append(f"    terms['{name} {goal['kind']}'] = {term}")
        if goal["kind"] == "resting" and goal in moving:
            terms.append(f"    terms['{name} on {goal['thing']}'] = {_onto(goal, facts)}")
        if goal in moving:
            trial.append(name)
    if not trial:
        return None
    let_go = {goal["object"] for goal in facts["goals"] if goal["kind"] == "released"}
    reach = [
        _reach(name, facts, name in let_go, [line for line in terms if f"'{name} " in line])
        for name in dict.fromkeys(trial)
    ]
    body = "\n".join([*terms, *reach])
    return PlanAnswer(
        code=f"def state_cost(self):\n{body}\n    return terms\n",
        explanation="Be near what is to be moved; every goal costs its distance; touch it anywhere.",
    )


def _reach(name: str, facts: SceneFacts, let_go: bool, goals: Sequence[str]) -> str:
    """Attract the hand to an object; if it must be released, only until its other goals are met, then repel it."""
    near = number(max(facts["objects"][name]["size_m"]) / 2 + MARGIN_M)
    reach = f"terms['{name} reach'] = 8.0 * clip(norm(self.ee_pos - self.{name}_pos) - {near}, 0.0, 1.0)"
    if not let_go:
        return f"    {reach}"
    missed = " + ".join(line.split("=")[0].strip() for line in goals)
    return (
        f"    done = near({missed}, {number(DONE)})\n    {reach} * (1.0 - done)\n"
        f"    terms['{name} released'] = done * self.{name}_hand_contact"
    )


def _term(goal: Goal) -> str | None:
    """Return the cost of a goal as program text; None if it cannot be expressed as a cost."""
    name = goal["object"]
    if goal["kind"] == "flipped":
        return _flipped(goal)
    if goal["kind"] == "at":
        return _at(goal)
    if goal["kind"] == "inside":
        return _inside(goal)
    if goal["kind"] == "lifted":
        return _lifted(goal)
    if goal["kind"] == "touched-while-turning":
        return f"1.0 - self.{name}_{goal['thing']}_contact"
    if goal["kind"] == "grasped":
        return f"2.0 - self.{name}_left_contact - self.{name}_right_contact"
    if goal["kind"] == "resting":
        return f"0.3 * norm(self.{name}_vel)"
    if goal["kind"] == "steady-force":
        force = f"norm(self.{name}_hand_force)"
        return f"0.05 * self.{name}_hand_contact * abs({force} - {number(goal['newtons'])})"
    if goal["kind"] == "undisturbed":
        return f"5.0 * norm(self.{name}_pos - self.{name}_init_pos)"
    return None


def _flipped(goal: FlippedGoal) -> str:
    axis = "xyz".index(goal["axis"])
    turned = f"dot({axis_of(goal['object'], axis)}, {axis_of(goal['object'], axis, 1.0, 'init_quat')})"
    return f"6.0 * abs({turned} - {number(np.cos(np.radians(goal['degrees'])))})"


def _at(goal: AtGoal) -> str:
    point = goal.get("point")
    where = f"self.{goal['object']}_{point}_pos" if point else f"self.{goal['object']}_pos"
    axes = ", ".join("1.0" if axis in goal["axes"] else "0.0" for axis in "xyz")
    return f"15.0 * norm(({where} - self.{goal['place']}_pos) * np.array([{axes}]))"


def _lifted(goal: LiftedGoal) -> str:
    risen = f"self.{goal['object']}_pos[2] - self.{goal['object']}_init_pos[2]"
    return f"15.0 * clip({number(goal['height_m'])} - ({risen}), 0.0, 1.0)"


def _inside(goal: InsideGoal) -> str:
    low, high = np.asarray(goal["low"], dtype=float), np.asarray(goal["high"], dtype=float)
    inward = np.minimum(EDGE_M, (high - low) / 4)
    at = f"self.{goal['object']}_pos"
    return f"15.0 * norm({at} - np.maximum({vector(low + inward)}, np.minimum({vector(high - inward)}, {at})))"


def _onto(goal: RestingGoal, facts: SceneFacts) -> str:
    """Return the program text for an object's distance from resting on something: horizontally and above its top."""
    thing, name = Thing(goal["object"], facts), goal["thing"]
    at = f"self.{thing.name}_pos"
    if name == "table":
        return f"15.0 * abs({at}[2] - {number(origin_height(thing))})"
    if name in facts["fixtures"]:
        middle = np.asarray(facts["fixtures"][name]["position"], dtype=float)
        aside = f"norm(({at} - {vector(middle)})[:2])"
    else:
        middle = Thing(name, facts).position
        aside = f"norm(({at} - self.{name}_pos)[:2])"
    height = (top_height(facts, name, middle[:2]) or 0.0) + origin_height(thing)
    return f"10.0 * ({aside} + abs({at}[2] - {number(height)}))"
