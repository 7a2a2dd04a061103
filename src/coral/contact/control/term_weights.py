"""Factors on the terms of the running cost, which a person may change while the robot moves."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import replace

from coral.contact.cost.context import Context, Terms
from coral.contact.cost.stages import Stage


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
