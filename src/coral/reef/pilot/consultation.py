"""One decision at a time, asked for on the side: its question, its verdicts, and the rules where an advisor failed."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from coral.advisor.attribution import Source, source_of, spent
from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.consult import Attempt, BudgetCfg, Outcome, consult
from coral.advisor.question import Advisor, Question, Rejection
from coral.reef.decide.own_parts import Verifier
from coral.reef.decide.planner import AskedState, HighLevelPlanner
from coral.reef.decide.questions import chosen
from coral.reef.drive.cost_to_go import CostToGo
from coral.reef.pilot.leftover import chain_of

Emit = Callable[..., None]
"""emit(event, **fields) appends to the run's events."""

RULES_BUDGET = BudgetCfg(max_requeries=7)
"""Answers of the rules that are verified before a fallback gives up for this time."""


@dataclass(frozen=True, kw_only=True)
class Decided:
    """How a decision ended."""

    number: int
    asked: AskedState | None
    """The last question, in whose state the answer was judged."""
    answer: Any
    """The accepted answer; None without one."""
    failure: str
    """As of `Outcome`."""
    source: Source
    by_rules: bool
    """Whether it was asked of the fallback."""


class AtOnce:
    """A clock on which advisors take no time: for rules that step in."""

    def __init__(self, clock: SimulatedClock | WallClock) -> None:
        self._clock = clock

    def now(self) -> float:
        """Return the time on the clock below (s)."""
        return self._clock.now()

    async def reply(self, asking: Callable[[], Any], timeout_s: float) -> Any:
        """Return the reply."""
        return await asking()


class Consultation:
    """Asks for a decision, and has its outcome when it is there; nothing waits for it."""

    def __init__(
        self,
        planner: HighLevelPlanner,
        advisor: Advisor,
        fallback: Advisor,
        clock: SimulatedClock | WallClock,
        way: CostToGo,
        emit: Emit,
        log: Callable[[Attempt], None],
        budget: BudgetCfg,
        prepare_s: float,
        verifier: Verifier | None = None,
    ) -> None:
        """Set up; a question takes `prepare_s` (s) to prepare, and `verifier` checks what the planner's checks pass."""
        self.advisor, self.fallback = advisor, fallback
        self.number = -1
        """Of the decision under way, or of the last one."""
        self._planner, self._clock, self._way, self._verifier = planner, clock, way, verifier
        self._budget, self._prepare_s = budget, prepare_s
        self._emit, self._log = emit, log
        self._task: asyncio.Task[Outcome[Any]] | None = None
        self._asked: AskedState | None = None
        self._by_rules = False
        self._attempts, self._mode, self._asked_s = 0, "", -math.inf

    @property
    def pending(self) -> bool:
        """Whether a decision is under way."""
        return self._task is not None

    def ask(self) -> None:
        """Ask the advisor for the next decision."""
        self._attempts, self.number, self._by_rules = 0, self.number + 1, False
        budget, clock, number = self._budget, self._clock, self.number
        asking = consult(self.advisor, self._observe, self._verify, budget, clock, self._attempted, number)
        self._task = clock.start(asking)

    def ask_rules(self) -> None:
        """Ask the fallback for the decision that the advisor did not reach."""
        self._by_rules, at_once = True, AtOnce(self._clock)
        asking = consult(self.fallback, self._observe_alone, self._verify, RULES_BUDGET, at_once, lambda _: None)
        self._task = self._clock.start(asking)

    def take(self) -> Decided | None:
        """Return how the decision ended, once; None while it is under way, and without one."""
        if self._task is None or not self._task.done():
            return None
        outcome, self._task = self._task.result(), None
        return Decided(
            number=self.number,
            asked=self._asked,
            answer=outcome.answer,
            failure=outcome.failure,
            source="fallback" if self._by_rules else source_of(self.advisor),
            by_rules=self._by_rules,
        )

    async def _observe(self, rejections: Sequence[Rejection]) -> Question[Any] | None:
        """Have the next question prepared, from the belief as it is now."""
        self._asked_s = self._clock.now()
        for guess in self._planner.settle():
            self._emit("guess", **asdict(guess))
        asked = await self._prepare(rejections)
        question = asked.question
        if question is None:
            return None
        if asked.mode != self._mode:
            self._mode = asked.mode
            self._emit("mode", mode=self._mode)
        self._emit(
            "question",
            decision=self.number,
            attempt=self._attempts,
            mode=self._mode,
            pictures=[p.digest for p in question.pictures],
            centroids=chain_of(asked.outlook.belief, asked.outlook.closed),
        )
        self._attempts += 1
        return question

    async def _observe_alone(self, rejections: Sequence[Rejection]) -> Question[Any] | None:
        """Have a question prepared for the rules: no question to the advisor, so none in its record."""
        return (await self._prepare(rejections)).question

    async def _prepare(self, rejections: Sequence[Rejection]) -> AskedState:
        """Make the next question on another thread, from a snapshot of the belief as it is now."""
        outlook, reasons = self._planner.outlook(self._way.field), list(rejections)
        self._asked = await self._clock.prepare(lambda: self._planner.ask(outlook, reasons), self._prepare_s)
        return self._asked

    def _verify(self, question: Question[Any], answer: Any) -> Rejection | None:
        """Check an answer to the last question, by the planner and then by the user's own verifier."""
        assert self._asked is not None
        refusal = self._planner.verify(self._asked, answer)
        if refusal is not None or self._verifier is None:
            return refusal
        refusal = self._verifier(question, answer)
        return None if refusal is None else replace(refusal, details={**refusal.details, **chosen(answer)})

    def _attempted(self, attempt: Attempt) -> None:
        refusal = attempt.rejection
        self._emit(
            "verdict",
            decision=attempt.decision,
            attempt=attempt.attempt,
            verdict=attempt.verdict,
            code=refusal.code if refusal else "",
            reason=refusal.reason if refusal else "",
            answer=attempt.answer,
            asked_at=round(attempt.asked_at_s, 3),
            **spent(attempt),
            **({"faults": list(attempt.usage.faults)} if attempt.usage.faults else {}),
        )
        if attempt.verdict in ("accepted", "rejected", "malformed"):
            self._planner.route.answered(attempt.answered_at_s - self._asked_s)
        self._log(attempt)
