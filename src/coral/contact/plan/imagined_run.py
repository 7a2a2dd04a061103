"""A plan followed in the planning world, before the robot moves: the control loop with few samples, in imagination.

How far it came is judged by the task's own conditions on the imagined states.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.mppi_controller import Controller, ControllerCfg
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.control.prediction import observation_of, states_under
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Progress, Strategy
from coral.contact.cost_program.errors import CostError
from coral.contact.scene.condition import HAND_PARTS
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import Contact, Observation, Truth
from coral.contact.scene.trial import Trial
from coral.mppi.knots import KnotMppiCfg

SEED = 20_261
"""The same samples at every call: one plan has one imagined run."""


REPLAN_STEPS = 4
"""Control steps between two plans."""
MOST_S = 6.0
"""Simulated time in which the beginnings of stages are looked for."""
CONTROLLER = replace(ControllerCfg(), mppi=KnotMppiCfg(samples=16, fine=0.0, spread_quantile=0.9))
"""The planner for that: where a stage begins is to be known to a centimetre or two. So few samples get further with
equal noise than with fine ones."""


@dataclass(frozen=True, eq=False)
class ImaginedMoment:
    """The moment of one plan."""

    now: Observation
    """The state for which the plan was made."""
    stage: str
    next_stage: str
    """The active stage after the conditions were tested: the same one, the next one, or one that it falls back to."""
    plan: HandPlan
    """The plan; its `now` holds the quantities of the state, the contacts too."""
    after: Context | None = None
    """The states after each control step until the next moment, Shape=(1, n); None if this motion diverges."""


def imagine(
    world: PlanningWorld, strategy: Strategy, now: Observation, most_s: float, cfg: ControllerCfg
) -> Iterator[ImaginedMoment]:
    """Follow a plan in the planning world, under the best belief.

    The run ends after `most_s`, when no rollout is valid, or when a cost cannot be evaluated.
    """
    controller = Controller(world, cfg, np.random.default_rng(SEED))
    progress, since, latest = Progress(strategy), now, None
    for step in range(0, round(most_s / world.cfg.step_s), REPLAN_STEPS):
        stage = progress.stage
        try:
            plan = controller.plan(now, stage, step, since, latest, REPLAN_STEPS if latest else 0)
            if not plan.valid or plan.now is None:
                return
            if progress.update(plan.now):
                since = now
        except CostError:
            return
        after = states_under(world, now, plan.targets[:REPLAN_STEPS], step)
        yield ImaginedMoment(now, stage.name, progress.stage.name, plan, after)
        now = now if after is None else observation_of(after, now)
        latest = plan.targets[REPLAN_STEPS - 1]


def stage_beginnings(
    world: PlanningWorld, strategy: Strategy, now: Observation, wanted: Sequence[str]
) -> dict[str, Observation]:
    """Return the states in which stages first begin when the plan is followed until all that are wanted have begun.

    Stages that are not reached are missing.
    """
    found = {strategy.begin or strategy.stages[0].name: now}
    for moment in imagine(world, strategy, now, MOST_S, CONTROLLER):
        found.setdefault(moment.next_stage, moment.now)
        if all(name in found for name in wanted):
            break
    return found


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
