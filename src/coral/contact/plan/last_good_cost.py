"""Fallback for a cost that fails: the last verified cost that worked."""

from __future__ import annotations

from collections.abc import Callable

from coral.contact.cost.context import Context, Cost, Terms
from coral.contact.cost_program.errors import CostError


class LastGoodCost:
    """A cost that falls back to its predecessor. It satisfies `coral.contact.cost.context.Cost`."""

    def __init__(self, failed: Callable[[CostError], None]) -> None:
        self._failed = failed
        self._good: list[Cost] = []
        self._bad: list[Cost] = []

    @property
    def name(self) -> str:
        """Return the name of the cost in use."""
        return self._good[-1].name if self._good else "none"

    def following(self, cost: Cost) -> Callable[[Context], Terms]:
        """Return a verified cost that is evaluated here: it is in use from its first evaluation until it fails."""

        def evaluate(state: Context) -> Terms:
            known = [*self._good[-1:], *self._bad]
            if not any(one is cost for one in known):
                self._good = [*self._good[-3:], cost]
            return self(state)

        return evaluate

    def __call__(self, state: Context) -> Terms:
        """Return the terms of the newest cost that works.

        Raises:
            CostError: None works; the error is that of the oldest.
        """
        error = CostError("killed", "there is no cost to plan with")
        while self._good:
            try:
                return self._good[-1](state)
            except CostError as failure:
                error = failure
                self._bad.append(self._good[-1])
                self._failed(failure)
                if len(self._good) == 1:
                    break
                self._good.pop()
        raise error
