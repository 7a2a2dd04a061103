"""A strategy as a list of stages: cost, contact points, stiffness, end condition, and factors that a person may set."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from coral.contact.cost.context import Array, Context, Terms

CostFunction = Callable[[Context], Terms]
Test = Callable[[Context], bool]


@dataclass(frozen=True)
class Guide:
    """Points to which some of the samples are guided (the candidates of Eq. 3, or any others)."""

    points: Callable[[Context], Array]
    """Function of the present state: tool positions, Shape=(n, 3) m in the world."""
    quaternion: Callable[[Context], Array] | None = None
    """Function of the present state: tool orientation there, Shape=(4,); None leaves it free."""
    opening_m: float | None = None
    """Opening there; None leaves it free."""


@dataclass(frozen=True)
class Stage:
    """One phase of a task."""

    name: str
    """Name for logs."""
    cost: CostFunction
    """Running cost (Eq. 5) as named terms."""
    guides: tuple[Guide, ...] = ()
    """Contact points."""
    stiffness_n_m: float = 600.0
    """Stiffness of the hand; low for stages that control a force."""
    until: Test | None = None
    """Ends the stage if true for the present state; None: never."""
    next: tuple[tuple[str, Test], ...] = ()
    """Ways to other stages, each with the condition for going there, such as back after a lost grasp: the first that
    holds, before `until`."""
    sigma: float | tuple[float, float, float, float, float, float, float] = 1.0
    """Factor on the sampling noise, or one for each of the target's x, y, z, its rotation about x, y, z of the hand,
    and the opening."""
    keeps_off: bool = False
    """Whether samples pay for pressing the hand on table and fixtures, beside what the cost says."""


@dataclass(frozen=True)
class Strategy:
    """Stages in order; a single stage is a single cost.

    Departs from the paper: it minimises one J for the whole task. Here an answer may have up to 64 stages, each with a
    cost, an end and ways to others, because long tasks need them; the prompt `paper` asks for one J.
    """

    name: str
    stages: tuple[Stage, ...]
    begin: str = ""
    """The stage that it begins with; "" for the first."""

    def stage(self, name: str) -> int:
        """Return the index of a stage by its name."""
        return next(k for k, stage in enumerate(self.stages) if stage.name == name)


class Progress:
    """The active stage of a strategy."""

    def __init__(self, strategy: Strategy) -> None:
        self.strategy, self.index = strategy, strategy.stage(strategy.begin) if strategy.begin else 0

    @property
    def stage(self) -> Stage:
        """Return the active stage."""
        return self.strategy.stages[self.index]

    def update(self, now: Context) -> bool:
        """Update the active stage from the present state, a batch of one; return True if it changed."""
        stage = self.stage
        for name, test in stage.next:
            if test(now):
                self.index = self.strategy.stage(name)
                return True
        if stage.until is not None and self.index + 1 < len(self.strategy.stages) and stage.until(now):
            self.index += 1
            return True
        return False


class TermWeights:
    """Factors by stage and term, 1 where none was set. Every method may be called from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._factors: dict[str, dict[str, float]] = {}
        self._news: list[tuple[str, str, float]] = []

    def set(self, stage: str, term: str, factor: float) -> None:
        """Multiply a term of a stage's cost by `factor` from the next plan on."""
        with self._lock:
            self._factors.setdefault(stage, {})[term] = factor
            self._news.append((stage, term, factor))

    def news(self) -> list[tuple[str, str, float]]:
        """Return what was set since the last call: stage, term, factor; of several values of one term the last."""
        with self._lock:
            latest = {(stage, term): factor for stage, term, factor in self._news}
            self._news = []
        return [(stage, term, factor) for (stage, term), factor in latest.items()]

    def weighed(self, stage: Stage) -> Stage:
        """Return a stage whose cost has the factors of now; the stage itself where there are none."""
        with self._lock:
            if stage.name not in self._factors:
                return stage

        def cost(state: Context) -> Terms:
            return self.weigh(stage.name, stage.cost(state))

        return replace(stage, cost=cost)

    def weigh(self, stage: str, terms: Terms) -> Terms:
        """Return the terms of a stage's cost times their factors."""
        with self._lock:
            factors: Mapping[str, float] = dict(self._factors.get(stage, {}))
        if not factors:
            return terms
        return {name: factors[name] * value if name in factors else value for name, value in terms.items()}
