"""What happens where the advisor did not decide: somebody stands in for it, or the episode ends."""

from __future__ import annotations

from collections.abc import Callable

from coral.advisor.fallback import Fallback, failed


class NoDecision(RuntimeError):
    """The advisor did not decide, and under the policy that was chosen nobody stands in for it.

    Args:
        policy: `hold` or `fail`.
        what: What was to be decided.
        failure: Why the advisor did not, as `consult` names it.
    """

    def __init__(self, policy: Fallback, what: str, failure: str) -> None:
        self.end_reason = failed(failure) if policy == "fail" else f"no-decision: {what}"
        super().__init__(f"the advisor did not decide on the {what} ({failure}), and nobody stands in ({policy})")


def fall_back(emit: Callable[..., None], policy: Fallback, what: str, failure: str, by: str) -> None:
    """Report that the advisor did not decide.

    Args:
        emit: Where to report.
        policy: What decides in its place.
        what: What was to be decided.
        failure: Why the advisor did not.
        by: Who stands in for it under `rules`.

    Raises:
        NoDecision: Nobody does.
    """
    who = by if policy == "rules" else "nobody"
    emit("fallback", what=what, by=who, because=failure, policy=policy, decided=what, source="fallback")
    if policy != "rules":
        raise NoDecision(policy, what, failure)
