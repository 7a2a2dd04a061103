"""Fallback for a cost that fails: the last verified cost that worked."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from coral.contact.cost.context import Context, Cost, Terms
from coral.contact.cost_program.errors import CostError
from coral.contact.plan.cost_check import verify_cost
from coral.contact.plan.cost_fault import CostCheckCfg, CostFault


class LastGoodCost:
    """A cost that falls back to its predecessor. It satisfies `coral.contact.cost.context.Cost`.

    Args:
        first: Initial cost, such as an expert's or a stored one; None if there is none.
        failed: Called with every cost that fails in use, and the reason.
    """

    def __init__(self, first: Cost | None = None, failed: Callable[[Cost, CostError], None] | None = None) -> None:
        self._good: list[Cost] = [] if first is None else [first]
        self._failed = failed
        self._bad: list[Cost] = []
        self.failures: list[CostError] = []

    @property
    def name(self) -> str:
        """Return the name of the cost in use."""
        return self._good[-1].name if self._good else "none"

    @property
    def current(self) -> Cost | None:
        """Return the cost in use."""
        return self._good[-1] if self._good else None

    def propose(self, cost: Cost, samples: Sequence[Context], cfg: CostCheckCfg | None = None) -> list[CostFault]:
        """Verify a cost and, if no fault is fatal, use it from now on.

        Returns:
            The faults; the cost is in use if none of them is fatal.
        """
        faults = verify_cost(cost, samples, cfg)
        if not any(fault.fatal for fault in faults):
            self._good = [*self._good[-3:], cost]
        return faults

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
                self.failures.append(failure)
                self._bad.append(self._good[-1])
                if self._failed is not None:
                    self._failed(self._good[-1], failure)
                if len(self._good) == 1:
                    break
                self._good.pop()
        raise error
