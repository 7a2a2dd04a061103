"""How far a plan came in its rehearsal: the task's own conditions, judged on imagined states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coral.contact.plan.imagined_run import ImaginedMoment
from coral.contact.scene.condition import HAND_PARTS
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import Contact, Truth
from coral.contact.scene.trial import Trial


@dataclass(frozen=True, order=True)
class ImaginedOutcome:
    """The outcome of a rehearsal; the larger one is the better one."""

    succeeded: bool
    """Whether the conditions of success held long enough."""
    stages: float
    """Share of the plan's stages that began; 1 after a success."""
    conditions: float
    """Share of the conditions that hold at the end. It counts after the stages: some hold while nothing is done."""
    spare_s: float
    """Time that was left when the last of these stages began; after a success, time that was left then (s)."""


def imagined_outcome(trial: Trial, moments: Sequence[ImaginedMoment], names: Sequence[str]) -> ImaginedOutcome:
    """Judge a rehearsal by the conditions of the task file.

    The judge sees what the planning world imagined from the perceived scene: nothing true, and forces only as contacts.

    Args:
        trial: The trial as the robot perceives it.
        moments: The rehearsal.
        names: The plan's stages in order.
    """
    if not moments:
        return ImaginedOutcome(False, 0.0, 0.0, 0.0)
    judge, end_s = Judge(trial), moments[-1].now.time_s
    furthest, since_s = 0, moments[0].now.time_s
    for moment in moments:
        if judge.success(imagined_truth(trial, moment)):
            return ImaginedOutcome(True, 1.0, 1.0, end_s - moment.now.time_s)
        index = names.index(moment.next_stage)
        if index > furthest:
            furthest, since_s = index, moment.now.time_s
    held = sum(judge.holding) / len(judge.holding)
    return ImaginedOutcome(False, (furthest + 1) / len(names), held, end_s - since_s)


def imagined_truth(trial: Trial, moment: ImaginedMoment) -> Truth:
    """Return an imagined state in the form in which the judge reads true ones; contacts have no force."""
    state, now = moment.plan.now, moment.now
    things = (*HAND_PARTS, *trial.task.things, *now.objects)
    contacts = []
    for name, body in now.objects.items():
        for other in things:
            key = f"{name}_{other}_contact"
            if key in state and bool(np.asarray(state[key]).any()):
                first, second = sorted((name, other))
                contacts.append(Contact(first, second, np.zeros(3), body.position))
    return Truth(now.time_s, now.tool, now.opening_m, now.objects, tuple(contacts))
