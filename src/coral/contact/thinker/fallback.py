"""What stands where the advisor does not decide: what is believed and followed already, or the episode ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from coral.advisor.fallback import failed

StandIn = Literal["prior", "hold", "fail"]
"""prior: prior masses and frictions, no contact regions, and the previous plan are used; without any plan the
episode ends. hold: the episode ends, and its reason names the open decision; only a plan without regions continues.
fail: it ends, and its reason names the failure."""


class NoDecision(RuntimeError):
    """The advisor did not decide, and the chosen policy lets nothing else stand."""

    def __init__(self, policy: StandIn, what: str, failure: str) -> None:
        self.end_reason = failed(failure) if policy == "fail" else f"no-decision: {what}"
        why = (
            "nothing can stand for it"
            if policy == "prior"
            else f"the fallback policy {policy!r} lets nothing else decide"
        )
        super().__init__(f"the advisor did not decide on the {what} ({failure}), and {why}")


def stand_in(emit: Callable[..., None], policy: StandIn, what: str, failure: str, by: str) -> None:
    """Report that the advisor did not decide and what stands instead: `by`, "" if nothing can.

    Raises:
        NoDecision: Nothing does.
    """
    stands = policy == "prior" and bool(by)
    who = by if stands else "nobody"
    emit("fallback", what=what, by=who, because=failure, policy=policy, decided=what, source="fallback")
    if not stands:
        raise NoDecision(policy, what, failure)
