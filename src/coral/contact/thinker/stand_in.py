"""The fallback when the advisor does not decide: rules answer, or the episode ends."""

from __future__ import annotations

from collections.abc import Callable

from coral.advisor.fallback import Fallback, failed


class NoDecision(RuntimeError):
    """The advisor did not decide, and the chosen policy lets nothing else decide.

    Args:
        policy: `hold` or `fail`.
        what: The open decision.
        failure: Why the advisor did not decide, as named by `consult`.
    """

    def __init__(self, policy: Fallback, what: str, failure: str) -> None:
        self.end_reason = failed(failure) if policy == "fail" else f"no-decision: {what}"
        super().__init__(
            f"the advisor did not decide on the {what} ({failure}), "
            f"and the fallback policy {policy!r} lets nothing else decide"
        )


def fall_back(emit: Callable[..., None], policy: Fallback, what: str, failure: str, by: str) -> None:
    """Report that the advisor did not decide and that a fallback does.

    Args:
        emit: Event sink.
        policy: The fallback policy.
        what: The open decision.
        failure: Why the advisor did not decide.
        by: What decides instead under `rules`.

    Raises:
        NoDecision: The policy is not `rules`.
    """
    who = by if policy == "rules" else "nobody"
    emit("fallback", what=what, by=who, because=failure, policy=policy, decided=what, source="fallback")
    if policy != "rules":
        raise NoDecision(policy, what, failure)
