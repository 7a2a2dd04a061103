"""The fallback when the advisor does not decide: rules answer, or the episode ends."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from pydantic import BaseModel

from coral.advisor.consult import Outcome, consult_at_once
from coral.advisor.fallback import Fallback, failed
from coral.advisor.question import Question, Rejection
from coral.advisor.rules import RuleAdvisor
from coral.advisor.setting import Rule

A = TypeVar("A", bound=BaseModel)


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


def ask_rules(
    rules: Mapping[str, Rule],
    kind: str,
    answer_type: type[A],
    facts: Mapping[str, Any],
    verify: Callable[[A], Rejection | None],
) -> Outcome[A]:
    """Let the rules answer a question that the advisor did not, through the checks of any answer.

    Args:
        rules: The rules by kind of question.
        kind: Kind of the question.
        answer_type: Type of its answer.
        facts: Its facts.
        verify: Returns why an answer is refused, or None.
    """
    question: Question[A] = Question(kind=kind, prompt="", answer_type=answer_type, facts=facts)
    return consult_at_once(RuleAdvisor(rules), lambda _: question, lambda _, answer: verify(answer))
