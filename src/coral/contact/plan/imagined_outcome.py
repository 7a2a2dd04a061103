"""How far a plan came in its imagined run: the task's own conditions, judged on imagined states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coral.contact.control.prediction import observation_of
from coral.contact.cost.context import Context
from coral.contact.plan.imagined_run import ImaginedMoment
from coral.contact.scene.condition import HAND_PARTS
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import Contact, Truth
from coral.contact.scene.trial import Trial


@dataclass(frozen=True, order=True)
class ImaginedOutcome:
    """The outcome of an imagined run; the larger one is the better one."""

    succeeded: bool
    """Whether the conditions of success held long enough."""
    stages: float
    """Share of the plan's stages that began; 1 after a success."""
    conditions: float
    """Share of the conditions that hold at the end. It counts after the stages: some hold while nothing is done."""
    spare_s: float
    """Time that the task's limit leaves after the begin of the last of these stages, or after the success (s)."""


class ImaginedJudge:
    """Judges an imagined run while it lasts, by the conditions of the task file.

    It sees what the planning world imagines from the perceived scene under believed masses and frictions: nothing true.
    `names` are the plan's stages in order.
    """

    def __init__(self, trial: Trial, names: Sequence[str]) -> None:
        self._trial, self._names, self._judge = trial, tuple(names), Judge(trial)
        self._began_s: float | None = None
        self._since_s, self._furthest = 0.0, 0
        self._held_first, self._held_most = 0, 0
        self.succeeded = False
        self.broken: tuple[str, ...] = ()
        """What can never be mended: conditions that break for good, but for limits on forces, and objects that fell off
        the table."""

    def update(self, moment: ImaginedMoment) -> None:
        """Judge a moment and the control steps after it; nothing changes after a success."""
        if self.succeeded:
            return
        if self._began_s is None:
            self._began_s = self._since_s = moment.now.time_s
        index = self._names.index(moment.next_stage)
        if index > self._furthest:
            self._furthest, self._since_s = index, moment.now.time_s
        for truth in imagined_truths(self._trial, moment):
            if self._judge.success(truth):
                self.succeeded, self._since_s = True, truth.time_s
                return
            held = sum(self._judge.holding)
            self._held_first = self._held_first if self._held_most else held
            self._held_most = max(self._held_most, held)
            self.broken = self._broken(truth)
            if self.broken:
                return

    def _broken(self, truth: Truth) -> tuple[str, ...]:
        # Blows are coarser here than in a world: good plans too break a limit on them, so it only counts among the
        # conditions.
        found = [f"{one.kind} of {one.object}" for one in self._judge.broken if not one.reads_forces]
        failure = self._judge.failure(truth) or ""
        # Real bodies do not pass through each other; coarse steps of the planning world let them.
        return (*found, *([failure] if failure and not failure.startswith("tunnelling") else []))

    @property
    def gained(self) -> bool:
        """Return whether more conditions held at some time than at the beginning."""
        return self._held_most > self._held_first

    @property
    def outcome(self) -> ImaginedOutcome:
        """Return how far the run has come."""
        if self._began_s is None:
            return ImaginedOutcome(False, 0.0, 0.0, 0.0)
        spare_s = self._began_s + self._trial.task.time_limit_s - self._since_s
        if self.succeeded:
            return ImaginedOutcome(True, 1.0, 1.0, spare_s)
        holding = self._judge.holding
        share = sum(holding) / len(holding) if holding else 0.0
        return ImaginedOutcome(False, (self._furthest + 1) / len(self._names), share, spare_s)


def imagined_truths(trial: Trial, moment: ImaginedMoment) -> list[Truth]:
    """Return the states after a moment, one for each control step, in the form in which the judge reads true ones.

    The hand's force on an object is that of the last physics step of each control step (10 ms of 20 by default), under
    the believed mass and friction. A world averages over all its physics steps (2 ms). So here a blow is either missed
    or counts as if it lasted for the whole control step, contacts chatter more, and a peak within a control step is
    unknown. Contacts between other things have no force.
    """
    states = moment.after
    return [] if states is None else [_truth_at(trial, moment, states, k) for k in range(states.shape[1])]


def _truth_at(trial: Trial, moment: ImaginedMoment, states: Context, index: int) -> Truth:
    now = observation_of(states, moment.now, index)
    things = (*HAND_PARTS, *trial.task.things, *now.objects)
    contacts = []
    for name, body in now.objects.items():
        for other in things:
            key = f"{name}_{other}_contact"
            if key in states and bool(np.asarray(states[key])[0, index]):
                first, second = sorted((name, other))
                force = np.zeros(3)
                if other == "hand":  # the sensor's force is that of all parts of the hand
                    force = np.asarray(states[f"{name}_hand_force"])[0, index] * (1.0 if second == name else -1.0)
                contacts.append(Contact(first, second, force, body.position))
    return Truth(now.time_s, now.tool, now.opening_m, now.objects, tuple(contacts))
