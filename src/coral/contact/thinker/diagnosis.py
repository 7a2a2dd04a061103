"""Diagnosis of a failing attempt from its history (3.4, A.9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict

import numpy as np

from coral.contact.scene.observation import Transition
from coral.contact.thinker.evidence import MOSTLY, Evidence
from coral.contact.thinker.plan_note import PlanNote

Diagnosis = Literal[
    "cost-error",
    "not-reached",
    "led-away",
    "out-of-reach",
    "pose-wrong",
    "slipped",
    "settled",
    "blocked",
    "not-moved",
    "moved-otherwise",
    "no-progress",
    "planner-weak",
]
TEXTS: Mapping[Diagnosis, str] = {
    "cost-error": "the cost could not be evaluated",
    "not-reached": "the hand never touched the object, and felt nothing that held it back: its cost does not lead it "
    "there, or the way in is wrong",
    "led-away": "the hand never touched the object and went away from it: a term of the cost has the wrong sign, or "
    "rewards the distance",
    "out-of-reach": "the hand stands at the edge of its workspace, or behind its commands although it feels nothing: "
    "its cost leads it to where the arm does not reach",
    "pose-wrong": "by the believed poses the hand is inside an object, or feels forces where nothing is near it, or "
    "forces that no rehearsal expects: an object is not where it is believed to be",
    "slipped": "contact was made and lost again and again",
    "settled": "the hand stays where it was told to be, and the stage does not end there: its cost leads to a "
    "wrong place, or the condition that ends it is wrong",
    "blocked": "the hand presses hard against what does not give way: its cost drives it in a wrong direction, or to a "
    "wrong side or place",
    "not-moved": "the hand pressed and the object hardly moved",
    "moved-otherwise": "the object moved, but not as rehearsed: the simulation believes in wrong parameters",
    "no-progress": "the cost fell no further, though nothing is visibly wrong: a side or grasp that leads nowhere",
    "planner-weak": "the planner found no way down the cost that more samples did find",
}


REST_S, REST_M = 2.0, 0.015
"""At rest is what is, in the mean of one half of this time, no further from where it was in the other. Rehearsals are
sampled: hand and object wander by a centimetre and more about where the cost leads them."""
AHEAD_M = 0.01
"""A command within this distance of the hand counts as reached."""
STILL_M = 0.004
"""An object that moved no further hardly moved."""
BLOCKED_N = 20.0
"""More than friction takes to push anything that the hand could lift, and half of what it yields to."""


class HistoryRow(TypedDict):
    """One control step as prompts and events show it: metres, newtons, world frame, quaternions (w, x, y, z).

    `touches` names what the fingers ("left", "right") and the palm ("hand") touch, as measured; a `cost` of None is
    unknown.
    """

    time_s: float
    object_pos: list[float]
    object_quat: list[float]
    object_moved_mm: float
    hand_pos: list[float]
    hand_quat: list[float]
    hand_told_to: list[float]
    opening_told_m: float
    force_on_hand_n: list[float]
    touches: list[str]
    cost: float | None


LOST_M = 0.05
"""A hand that ended so much farther from the object than it was went away from it."""
BEHIND_M = 0.02
"""A hand at rest that is so far behind its commands is held back."""
UNEXPLAINED = 0.5
"""Share of the felt forces without anything near from which a pose is doubted; tracked poses are off by millimetres."""
UNREHEARSED_N = 8.0
"""A force that differs so much from the rehearsed one comes from something that the rehearsals do not know: more than
what the worst beliefs of mass and friction explain of a push (5 N, measured)."""
OF_REHEARSED = 3.0
"""It also is so many times what was rehearsed: else the hand pushes what it means to push, and that is heavier."""
ALWAYS = 0.95
"""Share of the plans from which an object counts as touched all the time."""
FELT_PLANS = 0.2
"""Share of the plans at which a force must have been felt to doubt a pose."""
SUNK_PLANS = 0.05
"""Share of the plans with fingers inside the object from which its pose is doubted."""


def diagnose(
    steps: Sequence[Transition], name: str, returns: int, surprise_m: float, evidence: Evidence | None = None
) -> Diagnosis:
    """Diagnose the last part of an episode.

    Args:
        steps: The control steps to diagnose.
        name: The object concerned.
        returns: Number of times that the plan fell back to an earlier stage.
        surprise_m: Distance between the object and its predicted position after one step, summed over a second.
        evidence: What the record says besides; None judges by the steps alone.
    """
    if not steps:
        return "slipped" if returns >= 2 else "no-progress"
    if evidence is not None and _contradicts_the_pose(evidence):
        return "pose-wrong"
    if returns >= 2:
        return "slipped"
    if evidence is not None and _meets_the_unrehearsed(evidence):
        return "pose-wrong"
    if evidence is not None and evidence.at_edge >= MOSTLY and not evidence.touched and not evidence.felt:
        return "led-away" if evidence.largest_value < 0.0 else "out-of-reach"
    if _is_settled(steps) and not _presses_in_vain(evidence):
        return "settled"
    if _blocked(steps, name):
        return "blocked"
    felt = np.array([np.linalg.norm(step.after.wrench[:3]) for step in steps])
    moved = float(np.linalg.norm(steps[-1].after.objects[name].position - steps[0].before.objects[name].position))
    if surprise_m > 0.03:
        return "moved-otherwise"
    if felt.max() < 0.5:
        if evidence is not None and not evidence.touched:
            if evidence.last_m > evidence.first_m + LOST_M:
                return "led-away"
            if _is_held_back(steps):
                return "out-of-reach"
        return "not-reached"
    if moved < STILL_M and felt.mean() > 1.0:
        return "not-moved"
    return "no-progress"


def _is_settled(steps: Sequence[Transition]) -> bool:
    """Check whether hand and objects stay where they are, if they wander, and the hand is where its commands are.

    A blocked hand, or one that holds something too heavy, stays behind its commands and is not settled.
    """
    end_s = steps[-1].after.time_s
    last = [step for step in steps if step.after.time_s > end_s - REST_S]
    if end_s - steps[0].before.time_s < REST_S - 1e-9:
        return False
    earlier = [step.after.time_s <= end_s - REST_S / 2 for step in last]
    if all(earlier) or not any(earlier):
        return False
    places = np.array(
        [[step.after.tool.position, *(body.position for body in step.after.objects.values())] for step in last]
    )
    drift = places[np.logical_not(earlier)].mean(axis=0) - places[earlier].mean(axis=0)
    # Commands of a sampling planner wander about the hand: only what is left in the mean leads it anywhere.
    ahead = np.mean([step.command.position - step.after.tool.position for step in last], axis=0)
    return bool(np.linalg.norm(drift, axis=1).max() < REST_M and np.linalg.norm(ahead) < AHEAD_M)


def _contradicts_the_pose(evidence: Evidence) -> bool:
    """Check whether the hand is where the object should be, or feels what is not there, by the believed poses."""
    unexplained = evidence.felt >= FELT_PLANS and evidence.unexplained >= UNEXPLAINED
    return unexplained or evidence.sunk >= SUNK_PLANS


def _meets_the_unrehearsed(evidence: Evidence) -> bool:
    """Check whether the hand feels what no rehearsal expects, and not by holding what is heavier than believed."""
    unrehearsed = evidence.unrehearsed_n > max(UNREHEARSED_N, OF_REHEARSED * evidence.rehearsed_n)
    return evidence.felt >= FELT_PLANS and evidence.touched < ALWAYS and unrehearsed


def _presses_in_vain(evidence: Evidence | None) -> bool:
    """Check whether the hand has pressed on the object for most of the record, and it hardly moved."""
    return evidence is not None and (
        evidence.touched >= 0.5 and evidence.force_mean_n > 1.0 and evidence.moved_m < STILL_M
    )


def _is_held_back(steps: Sequence[Transition]) -> bool:
    """Check whether the hand has stood still behind its commands for a while."""
    end_s = steps[-1].after.time_s
    last = [step for step in steps if step.after.time_s > end_s - REST_S]
    if end_s - steps[0].before.time_s < REST_S - 1e-9:
        return False
    places = np.array([step.after.tool.position for step in last])
    behind = np.mean([step.command.position - step.after.tool.position for step in last], axis=0)
    return bool(
        np.linalg.norm(places - places.mean(axis=0), axis=1).max() < REST_M and np.linalg.norm(behind) > BEHIND_M
    )


def _blocked(steps: Sequence[Transition], name: str) -> bool:
    """Whether the hand has pressed hard in one direction for a while, and the object lies still."""
    end = steps[-1].after
    last = [step for step in steps if step.after.time_s > end.time_s - REST_S]
    if end.time_s - steps[0].before.time_s < REST_S - 1e-9:
        return False
    force = np.mean([step.after.wrench[:3] for step in last], axis=0)
    moved = np.linalg.norm(end.objects[name].position - last[0].before.objects[name].position)
    return bool(np.linalg.norm(force) > BLOCKED_N and moved < STILL_M)


REPAIR_ROWS = 3
"""Rows of the history in a question for another plan: the paper's five leave too little room for the rest in 3,000
tokens, and the evidence is in sentences beside them."""


def recent(
    steps: Sequence[Transition],
    costs: Sequence[tuple[float, float]],
    name: str,
    most: int = 5,
    notes: Sequence[PlanNote] = (),
) -> list[HistoryRow]:
    """Summarise the latest history in a few rows, as the prompts show it (the paper's last five steps).

    Args:
        steps: Control steps.
        costs: Costs of plans, each after the time of the plan.
        name: The object to report.
        most: Maximum number of rows.
        notes: Notes about the plans, each after the time of the plan.
    """
    if not steps:
        return []
    chosen = np.unique(np.linspace(0, len(steps) - 1, most).astype(int))
    rows: list[HistoryRow] = []
    for index in chosen:
        step = steps[int(index)]
        body, before = step.after.objects[name], step.before.objects[name]
        rows.append(
            {
                "time_s": round(step.after.time_s, 2),
                "object_pos": [round(float(v), 4) for v in body.position],
                "object_quat": [round(float(v), 3) for v in body.quaternion],
                "object_moved_mm": round(1e3 * float(np.linalg.norm(body.position - before.position)), 2),
                "hand_pos": [round(float(v), 4) for v in step.after.tool.position],
                "hand_quat": [round(float(v), 3) for v in step.after.tool.quaternion],
                "hand_told_to": [round(float(v), 4) for v in step.command.position],
                "opening_told_m": round(step.command.opening_m, 4),
                "force_on_hand_n": [round(float(v), 2) for v in step.after.wrench[:3]],
                "touches": _touches_at(notes, step.after.time_s),
                "cost": _cost_at(costs, step.before.time_s),
            }
        )
    return rows


def _cost_at(costs: Sequence[tuple[float, float]], time_s: float) -> float | None:
    """Return the cost of the latest plan made by that time."""
    made = [cost for when, cost in costs if when <= time_s + 1e-9] or [cost for _, cost in costs[:1]]
    return round(made[-1], 4) if made else None


def _touches_at(notes: Sequence[PlanNote], time_s: float) -> list[str]:
    """Return what was touched at the latest plan made by that time, as "part on thing"."""
    made = [note for note in notes if note.time_s <= time_s + 1e-9]
    return [f"{part} on {name}" for part, names in made[-1].touched.items() for name in names] if made else []


def recent_terms(notes: Sequence[PlanNote], most: int = 2, largest: int = 5) -> list[dict[str, Any]]:
    """Show which terms held the cost up over time.

    Args:
        notes: Notes about the plans.
        most: Maximum number of rows.
        largest: Maximum number of terms in a row, the largest ones.
    """
    if not notes:
        return []
    rows = []
    for index in np.unique(np.linspace(0, len(notes) - 1, most).astype(int)):
        note = notes[int(index)]
        terms = sorted(note.terms.items(), key=lambda item: -abs(item[1]))[:largest]
        rows.append(
            {
                "time_s": round(note.time_s, 2),
                "stage": note.stage,
                "terms": {name: float(f"{value:.3g}") for name, value in terms},
            }
        )
    return rows
