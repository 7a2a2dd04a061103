"""The generate-verify-correct loop: ask, check, feed the reason back, ask again with fresh pictures."""

from __future__ import annotations

import inspect
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Generic, Literal, Protocol, TypeVar

from pydantic import BaseModel, ValidationError

from coral.advisor.question import Advisor, AdvisorUnavailable, BadAnswer, Question, Rejection, Reply, Usage, Withdrawn
from coral.advisor.scrub import scrub, scrub_values
from coral.config import Positive

A = TypeVar("A", bound=BaseModel)
T = TypeVar("T")

Verdict = Literal["accepted", "rejected", "malformed", "unavailable", "withdrawn"]


DEADLINE_S = 60.0
"""Default deadline of a decision during a mission."""
LATE = "deadline"
"""Code of a question whose decision came to its deadline."""


@dataclass(frozen=True, kw_only=True)
class BudgetCfg:
    """Limits of one decision."""

    max_requeries: int = 3
    """Further attempts after the first; each rejected or malformed answer uses one."""
    deadline_s: Positive | None = None
    """Longest time for the whole decision, all attempts together, on the clock of the world (s); None: the
    application's default for the kind of question and of advisor."""

    def within(self, deadline_s: float) -> BudgetCfg:
        """Return the same budget, with a deadline if none is set."""
        return self if self.deadline_s is not None else replace(self, deadline_s=deadline_s)


@dataclass(frozen=True, kw_only=True)
class Attempt:
    """One line of the attempt log: the question, the reply, and the verdict."""

    decision: int
    """Number of the decision to which this attempt belongs, from 0 in each run."""
    attempt: int
    """0 for the first question of a decision, 1 for the first re-query, ..."""
    asked_at_s: float
    answered_at_s: float
    """Both on the clock of the world: simulated seconds in a simulation."""
    question: Question[Any]
    verdict: Verdict
    raw: str = ""
    answer: dict[str, Any] | None = None
    rejection: Rejection | None = None
    usage: Usage = field(default_factory=lambda: Usage(requests=0))
    final: bool = False
    """Whether the advisor reported that asking again cannot help."""


@dataclass(frozen=True, kw_only=True)
class Outcome(Generic[A]):
    """Result of a decision: an accepted answer, or a named failure."""

    answer: A | None
    question: Question[A] | None
    attempts: int
    failure: str = ""
    """"" if accepted; else "requeries-used-up", "deadline", "withdrawn" or the advisor's own code."""
    rejections: tuple[Rejection, ...] = ()


class Clock(Protocol):
    """The clock of the world."""

    def now(self) -> float:
        """Return seconds since the start of the run."""

    async def reply(self, asking: Callable[[], Any], timeout_s: float) -> Any:
        """Start `asking()` (a coroutine), and return its result when it arrives on this clock.

        Raises:
            TimeoutError: It did not arrive within `timeout_s` seconds of this clock.
            Withdrawn: The question was withdrawn meanwhile.
        """


async def consult(
    advisor: Advisor,
    observe: Callable[[Sequence[Rejection]], Question[A] | Awaitable[Question[A] | None] | None],
    verify: Callable[[Question[A], A], Rejection | None],
    budget: BudgetCfg,
    clock: Clock,
    log: Callable[[Attempt], None],
    decision: int = 0,
) -> Outcome[A]:
    """Reach one verified decision, or a named failure (paper CORAL III-D.3, Alg. 2).

    `observe` makes the question from the present world, given the reasons so far. None withdraws it: the world no
    longer needs an answer. It may take its time on the clock (an awaitable). `verify` checks an answer against the
    world at the time of its arrival; None accepts it. `log` receives every attempt, with the number of this decision.
    """
    rejections: list[Rejection] = []
    deadline_s = DEADLINE_S if budget.deadline_s is None else budget.deadline_s
    end = clock.now() + deadline_s
    question: Question[A] | None = None
    for attempt in range(budget.max_requeries + 1):
        try:
            observed = observe(rejections)
            question = await observed if inspect.isawaitable(observed) else observed
        except Withdrawn:
            question = None
        if question is None:
            return Outcome(answer=None, question=None, attempts=attempt, failure="withdrawn")
        asked_at_s = clock.now()
        question = replace(question, asked_at_s=asked_at_s)
        value, heard = await _ask(advisor, question, tuple(rejections), clock, end - asked_at_s, deadline_s)
        if value is not None and (refusal := verify(question, value)) is not None:
            heard |= {"verdict": "rejected", "rejection": refusal}
        made = Attempt(
            decision=decision,
            attempt=attempt,
            asked_at_s=asked_at_s,
            answered_at_s=clock.now(),
            question=question,
            answer=None if value is None else value.model_dump(mode="json"),
            **heard,
        )
        log(made)
        failure = "" if made.rejection is None else made.rejection.code
        if made.verdict in ("malformed", "rejected"):
            assert made.rejection is not None
            rejections.append(made.rejection)
        elif made.verdict != "unavailable" or made.final or failure == LATE:
            return Outcome(
                answer=value,
                question=question,
                attempts=attempt + 1,
                failure="withdrawn" if made.verdict == "withdrawn" else failure,
                rejections=(*rejections, *([] if made.rejection is None else [made.rejection])),
            )
    return Outcome(
        answer=None,
        question=question,
        attempts=budget.max_requeries + 1,
        failure="requeries-used-up",
        rejections=tuple(rejections),
    )


async def _ask(
    advisor: Advisor,
    question: Question[A],
    rejections: tuple[Rejection, ...],
    clock: Clock,
    timeout_s: float,
    deadline_s: float,
) -> tuple[A | None, dict[str, Any]]:
    """Ask once; return the answer, if there is one, and what the attempt heard: some fields of `Attempt`."""
    try:
        reply: Reply[A] = await clock.reply(partial(advisor.answer, question, rejections), timeout_s)
    except TimeoutError:
        silence = Rejection(code=LATE, reason=f"no answer within {deadline_s:g} s")
        return None, {"verdict": "unavailable", "rejection": silence}
    except Withdrawn:
        return None, {"verdict": "withdrawn"}
    except BadAnswer as bad:
        fault, raw = _without_keys(bad.rejection), scrub(bad.raw)
        return None, {"verdict": "malformed", "raw": raw, "rejection": fault, "usage": bad.usage}
    except AdvisorUnavailable as gone:
        absence = _without_keys(Rejection(code=gone.code, reason=gone.reason))
        return None, {"verdict": "unavailable", "rejection": absence, "usage": gone.usage, "final": gone.final}
    except Exception as error:
        # An exception in an advisor must cost only its answer, not the vehicle.
        fault = _without_keys(Rejection(code="advisor-error", reason=f"{type(error).__name__}: {error}"))
        return None, {"verdict": "unavailable", "rejection": fault}
    # A server may echo the key that it was sent: no part of a reply goes on before that is removed.
    raw, value, said = scrub(reply.raw), reply.value, reply.value.model_dump(mode="json")
    if (clean := scrub_values(said)) != said:
        try:
            value = type(value).model_validate(clean)
        except ValidationError:
            fault = Rejection(code="invalid", reason="The answer held a key of this environment.")
            return None, {"verdict": "malformed", "raw": raw, "rejection": fault, "usage": reply.usage}
    return value, {"verdict": "accepted", "raw": raw, "usage": reply.usage}


def _without_keys(rejection: Rejection) -> Rejection:
    details, listing = scrub_values(rejection.details), scrub(rejection.listing)
    return replace(rejection, reason=scrub(rejection.reason), details=details, listing=listing)
