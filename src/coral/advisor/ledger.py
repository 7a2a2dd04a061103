"""Spending of a run on its models, and its limits."""

from __future__ import annotations

from coral.advisor.model_cfg import SpendCfg
from coral.advisor.question import AdvisorUnavailable


class Ledger:
    """Counts requests, tokens and money of one run."""

    def __init__(self, cfg: SpendCfg) -> None:
        self.cfg = cfg
        self.calls = 0
        self.tokens = 0
        self.usd = 0.0

    def open_call(self) -> None:
        """Count one request before it is sent.

        Raises:
            AdvisorUnavailable: The budget is exhausted (code "budget", final).
        """
        bounds = (
            (self.calls, self.cfg.max_calls, "calls", "max_calls"),
            (self.tokens, self.cfg.max_tokens, "tokens", "max_tokens"),
            (self.usd, self.cfg.max_usd, "USD", "max_usd"),
        )
        for spent, bound, unit, name in bounds:
            if spent >= bound:
                raise AdvisorUnavailable(
                    "budget", f"the run's budget is used up: {spent:g} of {bound:g} {unit} (spend.{name})", final=True
                )
        self.calls += 1

    def add(self, tokens: int, usd: float) -> None:
        """Record the cost of a reply."""
        self.tokens += tokens
        self.usd += usd
