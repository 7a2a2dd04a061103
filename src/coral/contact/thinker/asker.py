"""Asks the advisor a question from inside an episode and waits for a verified answer."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from coral.advisor.attribution import Source, source_of, spent
from coral.advisor.consult import DEADLINE_S, Attempt, BudgetCfg, Outcome, consult
from coral.advisor.inner_loop import cancel_pending, run_on
from coral.advisor.latency import LatencyCfg
from coral.advisor.prompt import render
from coral.advisor.question import Advisor, Picture, Question, Rejection, trait
from coral.contact.perception.scene_labels import PictureLabels
from coral.contact.thinker.thinking_clock import ThinkingClock

A = TypeVar("A", bound=BaseModel)


class EpisodeOver(RuntimeError):
    """The episode ended while an advisor was answering: the decision is no longer needed."""


class Asker:
    """Asks one advisor, on one event loop, and counts its questions.

    `log` receives every attempt, which is also reported to `emit` as the event `verdict`. `pictures` are taken with the
    robot's camera, for advisors that read them. The clock is the episode's, if it continues while the advisor answers;
    by default time stops.
    """

    def __init__(
        self,
        advisor: Advisor,
        budget: BudgetCfg | None = None,
        log: Callable[[Attempt], None] | None = None,
        pictures: Callable[[PictureLabels | None], tuple[Picture, ...]] | None = None,
        clock: ThinkingClock | None = None,
    ) -> None:
        self.advisor, self.budget = advisor, (budget or BudgetCfg()).within(DEADLINE_S)
        still = LatencyCfg(kind="fixed", median_s=0.0)
        self.clock = clock or ThinkingClock(still, np.random.default_rng(0))
        self.emit: Callable[..., None] = lambda event, **fields: None
        self.log, self.pictures = log, pictures
        self.calls = 0
        self._decisions = 0
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def source(self) -> Source:
        """Return the source to which accepted answers are attributed."""
        return source_of(self.advisor)

    def ask(
        self,
        kind: str,
        answer_type: type[A],
        facts: Mapping[str, Any],
        prompt: Mapping[str, Any],
        verify: Callable[[A], Rejection | None],
        with_picture: bool = False,
        pictures: tuple[Picture, ...] = (),
        labels: PictureLabels | None = None,
    ) -> Outcome[A]:
        """Ask, verify the answer, and ask again with the reasons of its refusal.

        `kind` names the prompt's template, `prompt` has the values of its placeholders; `facts` are for advisors that
        read no pictures. `with_picture` adds one that is taken now, with `labels` written into it, to `pictures` taken
        before.

        Raises:
            EpisodeOver: The episode ended while the advisor was answering.
        """
        text, version = render(kind, prompt)
        if with_picture and self.pictures is not None:
            pictures = (*pictures, *self.pictures(labels))
        question: Question[A] = Question(
            kind=kind, prompt=text, answer_type=answer_type, facts=facts, pictures=pictures, prompt_version=version
        )

        def observe(rejections: Sequence[Rejection]) -> Question[A]:
            return question

        def count(attempt: Attempt) -> None:
            self.calls += 1
            self._report(attempt)
            if self.log is not None:
                self.log(attempt)

        decision, self._decisions = self._decisions, self._decisions + 1
        # All questions share a loop: a model's connections live in the loop that opened them.
        self._loop = self._loop or asyncio.new_event_loop()
        assert self.budget.deadline_s is not None
        self.clock.begin(kind, self.budget.deadline_s)
        asking = consult(
            self.advisor, observe, lambda _, answer: verify(answer), self.budget, self.clock, count, decision
        )
        outcome = run_on(self._loop, asking)
        if self.clock.fault is not None:
            raise self.clock.fault
        if outcome.failure == "withdrawn":
            raise EpisodeOver(kind)
        return outcome

    def _report(self, attempt: Attempt) -> None:
        refusal, faults = attempt.rejection, attempt.usage.faults
        self.emit(
            "verdict",
            kind=attempt.question.kind,
            decision=attempt.decision,
            attempt=attempt.attempt,
            verdict=attempt.verdict,
            code="" if refusal is None else refusal.code,
            thinking_s=round(attempt.answered_at_s - attempt.asked_at_s, 6),
            **spent(attempt),
            **({"faults": list(faults)} if faults else {}),
        )

    def close(self) -> None:
        """Close the advisor and the loop."""
        if self._loop is None:
            return
        cancel_pending(self._loop)
        if (aclose := trait(self.advisor, "aclose")) is not None:
            run_on(self._loop, aclose())
        self._loop.close()
        self._loop = None
