"""When to think again (section 3.4): attempts without progress are counted, and what they looked like is kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from coral.config import Count, Fraction, NonNegative, Positive
from coral.contact.scene.observation import Transition
from coral.contact.thinker.strategist import PlanReport


@dataclass(frozen=True, kw_only=True)
class OuterCfg:
    """The outer loop.

    Args:
        n_retry: Attempts without progress before the advisor is asked (paper, section 4).
        attempt_s: Simulated time that counts as one attempt of the inner loop, which replans every 20 to 40 ms: with
            n_retry it makes the 3 s after which a person would say that it is stuck.
        progress: The expected cost must fall by this share of what it was when the stage began, to count as progress.
        progress_m: So does an object that is this much farther than ever from where the stage found it: a slow, steady
            push does what it should while its cost, of pace and force, stays as it is.
        refinements: Most refinements in one episode.
        history_s: How much of the past is looked at.
        replay_dt_s: Step of the physics in replays, finer than in rehearsals.
        sunk_m: Stretches at whose beginning an object is seen deeper in the table are not replayed.
    """

    n_retry: Count = 15
    attempt_s: Positive = 0.2
    progress: Fraction = 0.02
    progress_m: Positive = 0.01
    refinements: NonNegative = 5
    history_s: Positive = 6.0
    replay_dt_s: Positive = 0.004
    sunk_m: Positive = 0.002


@dataclass
class ProgressMonitor:
    """Counts attempts without progress and remembers the recent past.

    Args:
        cfg: The outer loop.
        order: The stages' names, in order.
    """

    cfg: OuterCfg
    order: tuple[str, ...]
    attempts: int = 0
    returns: int = 0
    steps: list[Transition] = field(default_factory=list)
    costs: list[tuple[float, float]] = field(default_factory=list)
    surprise_m: Mapping[str, float] = field(default_factory=dict)
    _farthest: int = -1
    _stage: int = -1
    _first: float = 0.0
    _best: float = np.inf
    _since: float = 0.0
    _expected: Mapping[str, np.ndarray] = field(default_factory=dict)
    _found: Mapping[str, np.ndarray] = field(default_factory=dict)
    _moved: dict[str, float] = field(default_factory=dict)

    def see(self, moment: PlanReport) -> bool:
        """Look at a plan; true when n_retry attempts have brought nothing."""
        now = moment.now.time_s
        self._remember(moment)
        stage, cost = self.order.index(moment.stage), moment.plan.cost
        self.returns += stage < self._stage
        if stage != self._stage:
            # Another stage has another cost; falling back and coming again is no progress.
            progressed = stage > self._farthest
            self._farthest, self._stage = max(stage, self._farthest), stage
            self._first, self._best = cost, cost
            if progressed:
                self._found = {name: body.position.copy() for name, body in moment.now.objects.items()}
                self._moved = {}
                self._progress(now)
        elif self._farther(moment) and stage >= self._farthest:
            self._progress(now)
        elif cost < self._best - self.cfg.progress * max(abs(self._first), 0.1):
            self._best = cost
            if stage >= self._farthest:
                self._progress(now)
        if now - self._since >= self.cfg.attempt_s - 1e-9:
            self.attempts, self._since = self.attempts + 1, now
        return self.attempts >= self.cfg.n_retry

    def _farther(self, moment: PlanReport) -> bool:
        farther = False
        for name, start in self._found.items():
            way = float(np.linalg.norm(moment.now.objects[name].position - start))
            if way > self._moved.get(name, 0.0) + self.cfg.progress_m:
                self._moved[name], farther = way, True
        return farther

    def _progress(self, now: float) -> None:
        self.attempts, self._since = 0, now

    def _remember(self, moment: PlanReport) -> None:
        self.steps += moment.taken
        self.costs.append((moment.now.time_s, moment.plan.cost))
        surprise = dict(self.surprise_m)
        for name, place in self._expected.items():
            if moment.taken:
                off = float(np.linalg.norm(moment.taken[0].after.objects[name].position - place))
                # Leaks over about a second, so that old surprises are forgotten.
                surprise[name] = 0.96 * surprise.get(name, 0.0) + off
        self.surprise_m = surprise
        names = list(moment.now.objects)
        self._expected = {name: np.asarray(moment.plan.now[f"{name}_pos"])[0, 0] for name in names}
        horizon = moment.now.time_s - self.cfg.history_s
        while self.steps and self.steps[0].before.time_s < horizon:
            self.steps.pop(0)
        while self.costs and self.costs[0][0] < horizon:
            self.costs.pop(0)
