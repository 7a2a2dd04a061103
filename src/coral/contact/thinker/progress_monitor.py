"""When to replan (section 3.4): counts attempts without progress, and keeps the recent history and what plans said."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import exp

import numpy as np

from coral.config import Count, Fraction, NonNegative, Positive
from coral.contact.plan.stage_end import PartReading, StageEnd
from coral.contact.scene.observation import Array, Transition
from coral.contact.thinker.strategist import PlanReport

HISTORY_S = 6.0
"""Length of the history that diagnosis and correction use."""
SURPRISE_TAU_S = 0.97986393046407
"""Time constant of the decay of surprises: 0.96 is kept from plan to plan at the default interval of 0.04 s."""
FORCE_STEPS = 5
"""Control steps over which the predicted force is averaged: a contact chatters from step to step."""


@dataclass(frozen=True, kw_only=True)
class OuterCfg:
    """When the outer loop steps in."""

    n_retry: Count = 15
    """Attempts without progress before the advisor is asked (paper, section 4)."""
    attempt_s: Positive = 0.2
    """Simulated time that counts as one attempt of the inner loop, which replans every 20 to 40 ms: n_retry attempts
    make 3 s, after which a person would call it stuck. Departs from the paper: its attempt is one plan, as under
    --variant paper."""
    progress: Fraction = 0.02
    """Progress is a fall of the expected cost by this share of its value when the stage began, or of its fall since."""
    progress_m: Positive = 0.01
    """An object that is this much farther than ever from its position when the stage began is progress too: a slow,
    steady push succeeds while its cost, of speed and force, stays constant."""
    refinements: NonNegative = 5
    """Maximum number of refinements in one episode."""


@dataclass
class ProgressMonitor:
    """Detects that the inner loop is stuck: in n_retry attempts neither the cost fell nor an object moved farther."""

    cfg: OuterCfg
    """Thresholds."""
    order: tuple[str, ...]
    """Names of the stages, in order."""
    ends: Mapping[str, StageEnd] = field(default_factory=dict)
    """Their ends by name, where known."""
    attempts: int = 0
    """Attempts since the last progress."""
    returns: int = 0
    """Number of times that the plan fell back to an earlier stage."""
    steps: list[Transition] = field(default_factory=list)
    """Control steps of the last `HISTORY_S`."""
    costs: list[tuple[float, float]] = field(default_factory=list)
    """Costs of the plans, each after the time of the plan."""
    notes: list[PlanNote] = field(default_factory=list)
    """Stage, terms and contacts of the plans of the last `HISTORY_S`."""
    first_ends: dict[str, tuple[PartReading, ...]] = field(default_factory=dict)
    """The comparisons that end a stage as they were at its first plan, by stage."""
    surprise_m: Mapping[str, float] = field(default_factory=dict)
    """By object, the distance between its position after a plan's first step and the predicted one, summed with a decay
    of `SURPRISE_TAU_S`."""
    _stage: int = -1
    _farthest_stage: int = -1
    _first_cost: dict[int, float] = field(default_factory=dict)
    _best_cost: dict[int, float] = field(default_factory=dict)
    _attempt_began_s: float = 0.0
    _reported_s: float = 0.0
    _expected: Mapping[str, Array] = field(default_factory=dict)
    _start: Mapping[str, Array] = field(default_factory=dict)
    _farthest_m: dict[str, float] = field(default_factory=dict)

    @property
    def stage(self) -> str:
        """Return the name of the stage of the latest plan; "" before the first."""
        return self.notes[-1].stage if self.notes else ""

    def update(self, report: PlanReport) -> bool:
        """Add a plan; return True after n_retry attempts without progress."""
        now = report.now.time_s
        self._remember(report)
        stage, cost = self.order.index(report.stage), report.plan.cost
        self.returns += stage < self._stage
        if stage != self._stage:
            # Costs of different stages are not comparable; falling back and returning is no progress, nor is a cost
            # that falls as it did the last time: a slipping grasp would continue for ever.
            progressed = stage > self._farthest_stage
            self._farthest_stage, self._stage = max(stage, self._farthest_stage), stage
            self._first_cost.setdefault(stage, cost)
            self._best_cost[stage] = min(cost, self._best_cost.get(stage, cost))
            if progressed:
                self._start = {name: body.position.copy() for name, body in report.now.objects.items()}
                self._farthest_m = {}
                self._restart_attempts(now)
        elif self._moved_farther(report) and stage >= self._farthest_stage:
            self._restart_attempts(now)
        elif cost < self._best_cost[stage] - self.cfg.progress * self._scale(stage):
            self._best_cost[stage] = cost
            if stage >= self._farthest_stage:
                self._restart_attempts(now)
        if now - self._attempt_began_s >= self.cfg.attempt_s - 1e-9:
            self.attempts, self._attempt_began_s = self.attempts + 1, now
        return self.attempts >= self.cfg.n_retry

    def _scale(self, stage: int) -> float:
        """Return the cost by which progress is measured: at the stage's begin, or the fall since, if that is more.

        A reward without bound would else fall for ever by small shares of a small first cost.
        """
        first = self._first_cost[stage]
        return max(abs(first), first - self._best_cost[stage], 0.1)

    def _moved_farther(self, report: PlanReport) -> bool:
        """Check whether an object is farther than ever from its position when the stage began."""
        farther = False
        for name, start in self._start.items():
            distance = float(np.linalg.norm(report.now.objects[name].position - start))
            if distance > self._farthest_m.get(name, 0.0) + self.cfg.progress_m:
                self._farthest_m[name], farther = distance, True
        return farther

    def _restart_attempts(self, now: float) -> None:
        self.attempts, self._attempt_began_s = 0, now

    def _remember(self, report: PlanReport) -> None:
        self.steps += report.taken
        self.costs.append((report.now.time_s, report.plan.cost))
        note = note_of(report, self.ends.get(report.stage))
        self.notes.append(note)
        if note.end:
            self.first_ends.setdefault(note.stage, note.end)
        self._add_surprises(report)
        horizon = report.now.time_s - HISTORY_S
        self.steps = [step for step in self.steps if step.before.time_s >= horizon]
        self.costs = [(time_s, cost) for time_s, cost in self.costs if time_s >= horizon]
        self.notes = [note for note in self.notes if note.time_s >= horizon]

    def _add_surprises(self, report: PlanReport) -> None:
        # Sums of control periods differ in their last bits; the decay of a surprise must not.
        elapsed_s = round(report.now.time_s - self._reported_s, 9)
        kept = exp(-elapsed_s / SURPRISE_TAU_S)
        surprise = dict(self.surprise_m)
        for name, place in self._expected.items():
            if report.taken:
                off = float(np.linalg.norm(report.taken[0].after.objects[name].position - place))
                surprise[name] = kept * surprise.get(name, 0.0) + off
        self.surprise_m, self._reported_s = surprise, report.now.time_s
        expected = report.next_state
        self._expected = (
            {} if expected is None else {name: np.asarray(expected[f"{name}_pos"])[0, 0] for name in report.now.objects}
        )


@dataclass(frozen=True)
class PlanNote:
    """What is known of one plan of the inner loop."""

    time_s: float
    stage: str
    terms: Mapping[str, float]
    """Expected value of each term of its cost over the horizon."""
    touched: Mapping[str, tuple[str, ...]]
    """What the parts of the hand touched, as measured."""
    expected_force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Force on the hand (N) that the rollouts predict, the mean of the first `FORCE_STEPS` control steps."""
    sunk_m: Mapping[str, float] = field(default_factory=dict)
    """How deep (m) the hand was inside each object by the believed poses."""
    at_edge: float = 0.0
    """Share of the plan's targets at the edge of the workspace or of the arm's reach."""
    end: tuple[PartReading, ...] = ()
    """The comparisons of the condition that ends the stage, in the measured state; () if unknown."""


def note_of(report: PlanReport, end: StageEnd | None = None) -> PlanNote:
    """Return what is kept of a report, with the end of its stage."""
    plan = report.plan
    force = plan.expected_force
    x, y, z = (0.0, 0.0, 0.0) if force is None else np.mean(np.asarray(force)[:FORCE_STEPS], axis=0)
    return PlanNote(
        report.now.time_s,
        report.stage,
        dict(plan.terms),
        dict(report.touched),
        (float(x), float(y), float(z)),
        dict(report.sunk_m),
        plan.at_edge,
        () if end is None or report.present is None else end.read(report.present),
    )
