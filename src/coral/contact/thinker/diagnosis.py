"""Diagnosis of a failing attempt from its history (3.4, A.9).

Departs from the paper: there the model finds out what failed. Here rules name it, with the evidence, and the question
for a repair tells both; the prompt `paper` tells neither.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from coral.contact.plan.stage_end import TRUTH
from coral.contact.scene.observation import Transition
from coral.contact.thinker.evidence import CROSSED, MOSTLY, Evidence

Diagnosis = str
"""One of `TEXTS`."""
TEXTS: Mapping[Diagnosis, str] = {
    "cost-error": "the cost could not be evaluated",
    "not-reached": "the hand does not touch the object: its cost does not lead it there, or the way in is wrong",
    "passes-over": "the hand passes over the object, which hardly moves: it is too high, such as where a height is a "
    "number and this object is lower than others",
    "led-away": "the hand never touched the object and went away from it: a term of the cost has the wrong sign, or "
    "rewards the distance",
    "out-of-reach": "the hand stands at the edge of its workspace, or behind its commands although it feels nothing: "
    "its cost leads it to where the arm does not reach",
    "pose-wrong": "by the believed poses the hand is inside an object, or feels forces where nothing is near or that "
    "no rollout predicts: an object is not where it is believed to be",
    "slipped": "contact was made and lost again and again",
    "settled": "the hand stays where it was told to be, and the stage does not end there: its cost leads to a "
    "wrong place",
    "stage-never-ends": "the hand stays where it was told to be, about where the stage should end, and the stage does "
    "not end: the condition that ends it asks for what is not reached or cannot be",
    "not-gripped": "the hand is around the object with open fingers, which were never told to close on it: if it "
    "has to be held, a term or a stage that closes them is missing",
    "blocked": "the hand presses hard against what does not give way: its cost drives it in a wrong direction, or to a "
    "wrong side or place",
    "not-moved": "the hand pressed and the object hardly moved",
    "moved-otherwise": "the object moved, but not as predicted: the simulation believes in wrong parameters",
    "no-progress": "the cost fell no further, though nothing is visibly wrong: a side or grasp that leads nowhere",
}


REST_S, REST_M = 2.0, 0.015
"""A thing is at rest if its mean place in one half of this time is no further from that in the other. Rollouts are
sampled: hand and object wander by a centimetre and more about where the cost leads them."""
AHEAD_M = 0.01
"""A command within this distance of the hand counts as reached."""
STILL_M = 0.004
"""An object that moved no further hardly moved."""
YIELDS_M = 0.02
"""One that moved no further under a hand at rest only slips away: it turns on the spot under what presses on it."""
BLOCKED_N = 20.0
"""More than friction takes to push anything that the hand could lift, and half of what it yields to."""


OUTRUN = 0.5
"""An object that moved less than this share of the hand's way over it was passed, not pushed."""
LOST_M = 0.05
"""A hand that ended so much farther from the object than it was went away from it."""
AT_OBJECT_M = 0.02
"""A hand within this distance of the object's bounding box is at the object."""
BEHIND_M = 0.02
"""A hand at rest that is so far behind its commands is held back."""
UNEXPLAINED = 0.5
"""Share of the felt forces without anything near from which a pose is doubted; tracked poses are off by millimetres."""
UNPREDICTED_N = 8.0
"""A force that differs this much from the predicted one comes from something that rollouts do not know: more than
what the worst beliefs of mass and friction explain of a push (5 N, measured)."""
OF_PREDICTED = 3.0
"""It is also this many times what was predicted: otherwise the hand pushes what it means to push, only heavier."""
ALWAYS = 0.95
"""Share of the plans from which an object counts as touched all the time."""
FELT_NOTHING_N = 0.5
"""A hand that feels less touches nothing."""
BRUSHED = 0.1
"""A hand that touched the object at a smaller share of the plans brushed it."""
CLOSED = 0.05
"""Share of the time for which fingers must have been told to close on something, to have tried it."""
FELT_PLANS = 0.2
"""Share of the plans at which a force must have been felt to doubt a pose."""
SUNK_PLANS = 0.05
"""Share of the plans with fingers inside the object from which its pose is doubted."""


def diagnose(
    steps: Sequence[Transition], name: str, returns: int, surprise_m: float, evidence: Evidence | None
) -> Diagnosis:
    """Diagnose the last part of an episode, in which the plan fell back so many times (`returns`) to an earlier stage.

    `surprise_m` is the distance between the object and its predicted position after one step, summed over a second.
    `evidence` is what the record of these steps says; None without a step.
    """
    if evidence is None:
        return "slipped" if returns >= 2 else "no-progress"
    if _contradicts_the_pose(evidence):
        return "pose-wrong"
    if returns >= 2:
        return "slipped"
    if _feels_the_unpredicted(evidence):
        return "pose-wrong"
    if evidence.at_edge >= MOSTLY and not evidence.touched and not evidence.felt:
        return "led-away" if evidence.largest_value < 0.0 else "out-of-reach"
    if _never_closed(evidence):
        return "not-gripped"
    if evidence.end.misses_by_little and _rests(_late(steps)):
        return "stage-never-ends"  # it may press on what keeps it from the last millimetres
    if _is_settled(steps):
        if _ends_wrongly(evidence):
            return "stage-never-ends"
        if not _presses_in_vain(evidence):
            return "settled"
    if _blocked(steps, name):
        return "blocked"
    felt = np.array([np.linalg.norm(step.after.wrench[:3]) for step in steps])
    moved = float(np.linalg.norm(steps[-1].after.objects[name].position - steps[0].before.objects[name].position))
    if surprise_m > 0.03:
        return "moved-otherwise"
    if evidence.crossed >= CROSSED and moved < OUTRUN * evidence.passed_m:
        return "passes-over"
    touched = felt.max() >= FELT_NOTHING_N and not _only_brushed(steps, evidence)
    if not touched and not evidence.touched and evidence.last_m > evidence.first_m + LOST_M:
        return "led-away"
    if not touched and not evidence.touched and _is_held_back(steps):
        return "out-of-reach"
    if not touched or not evidence.touched:
        return "not-reached"  # what it felt was something else
    if moved < STILL_M and felt.mean() > 1.0:
        return "not-moved"
    return "no-progress"


def _late(steps: Sequence[Transition]) -> Sequence[Transition]:
    """Return the steps of the last `REST_S`; none if the record is shorter."""
    end_s = steps[-1].after.time_s
    if end_s - steps[0].before.time_s < REST_S - 1e-9:
        return ()
    return [step for step in steps if step.after.time_s > end_s - REST_S]


def _is_settled(steps: Sequence[Transition]) -> bool:
    """Check whether hand and objects stay where they are, if they wander, and the hand is where its commands are.

    A blocked hand, or one that holds something too heavy, stays behind its commands and is not settled.
    """
    last = _late(steps)
    if not _rests(last):
        return False
    # Commands of a sampling planner wander about the hand: only their mean leads it anywhere.
    ahead = np.mean([step.command.position - step.after.tool.position for step in last], axis=0)
    return bool(np.linalg.norm(ahead) < AHEAD_M)


def _rests(last: Sequence[Transition]) -> bool:
    """Check whether hand and objects keep their mean place from the first to the second half of some steps."""
    middle_s = last[-1].after.time_s - REST_S / 2 if last else 0.0
    earlier = [step.after.time_s <= middle_s for step in last]
    if all(earlier) or not any(earlier):
        return False
    places = np.array(
        [[step.after.tool.position, *(body.position for body in step.after.objects.values())] for step in last]
    )
    drift = places[np.logical_not(earlier)].mean(axis=0) - places[earlier].mean(axis=0)
    return bool(np.linalg.norm(drift, axis=1).max() < REST_M)


def _contradicts_the_pose(evidence: Evidence) -> bool:
    """Check whether the hand is where the object should be, or feels what is not there, by the believed poses."""
    unexplained = evidence.felt >= FELT_PLANS and evidence.unexplained >= UNEXPLAINED
    return unexplained or evidence.sunk >= SUNK_PLANS


def _feels_the_unpredicted(evidence: Evidence) -> bool:
    """Check whether the hand feels what no rollout predicts, other than by holding something heavier than believed."""
    unpredicted = evidence.unpredicted_n > max(UNPREDICTED_N, OF_PREDICTED * evidence.predicted_n)
    return evidence.felt >= FELT_PLANS and evidence.touched < ALWAYS and unpredicted


def _ends_wrongly(evidence: Evidence) -> bool:
    """Check whether the cost has led where it should, and only the stage's end does not hold.

    So it is if only a contact is missing where the hand or the object should be, or if a cost, not a reward, has led
    the hand to the object and away from the end.
    """
    end = evidence.end
    at_object = evidence.last_m < AT_OBJECT_M and evidence.largest_value >= 0.0
    return end.lacks_only_a_contact or (at_object and end.recedes(LOST_M))


def _never_closed(evidence: Evidence) -> bool:
    """Check whether open fingers stand on both sides of the object, and close neither now nor for the stage to end."""
    end = evidence.end
    waits = bool(end.parts) and not all(part.part.unit == TRUTH for part in end.unmet)
    return evidence.around >= MOSTLY and evidence.closing < CLOSED and not waits and not end.lacks_only_a_contact


def _only_brushed(steps: Sequence[Transition], evidence: Evidence) -> bool:
    """Check whether the hand hardly touched the object, and has felt nothing for a while."""
    end_s = steps[-1].after.time_s
    late = [np.linalg.norm(step.after.wrench[:3]) for step in steps if step.after.time_s > end_s - REST_S]
    return evidence.touched < BRUSHED and evidence.last_m > AT_OBJECT_M and bool(max(late) < FELT_NOTHING_N)


def _presses_in_vain(evidence: Evidence) -> bool:
    """Check whether the hand has pressed on the object for most of the record, and it hardly moved."""
    return evidence.touched >= 0.5 and evidence.force_mean_n > 1.0 and evidence.moved_m < STILL_M


def _is_held_back(steps: Sequence[Transition]) -> bool:
    """Check whether the hand has stood still behind its commands for a while."""
    last = _late(steps)
    if not last:
        return False
    places = np.array([step.after.tool.position for step in last])
    behind = np.mean([step.command.position - step.after.tool.position for step in last], axis=0)
    return bool(
        np.linalg.norm(places - places.mean(axis=0), axis=1).max() < REST_M and np.linalg.norm(behind) > BEHIND_M
    )


def _blocked(steps: Sequence[Transition], name: str) -> bool:
    """Whether the hand has pressed hard in one direction for a while, and the object hardly yields."""
    end, last = steps[-1].after, _late(steps)
    if not last:
        return False
    force = np.mean([step.after.wrench[:3] for step in last], axis=0)
    moved = np.linalg.norm(end.objects[name].position - last[0].before.objects[name].position)
    lies = moved < (YIELDS_M if _is_held_back(steps) else STILL_M)
    return bool(np.linalg.norm(force) > BLOCKED_N and lies)
