"""Asks the advisor a question from inside an episode and waits for a verified answer."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel

from coral.advisor.clock import WallClock
from coral.advisor.consult import Attempt, BudgetCfg, Outcome, consult
from coral.advisor.inner_loop import run_on
from coral.advisor.prompt import render
from coral.advisor.question import Advisor, Picture, Question, Rejection

A = TypeVar("A", bound=BaseModel)


class Asker:
    """One advisor, one event loop, one count of questions. The robot stands still while it waits.

    Simulated time does not pass meanwhile: the advisor is asked before the task begins, or while the hand holds still.

    Args:
        advisor: Who is asked.
        budget: Attempts and time for each decision; time is wall time.
        log: Receives every attempt.
        pictures: What the robot's camera sees now, for advisors with eyes.
    """

    def __init__(
        self,
        advisor: Advisor,
        budget: BudgetCfg | None = None,
        log: Callable[[Attempt], None] | None = None,
        pictures: Callable[[], tuple[Picture, ...]] | None = None,
    ) -> None:
        self.advisor, self.budget = advisor, budget or BudgetCfg()
        self.log, self.pictures = log, pictures
        self.calls = 0
        self._decisions = 0
        self._loop: asyncio.AbstractEventLoop | None = None

    def ask(
        self,
        kind: str,
        answer_type: type[A],
        facts: Mapping[str, Any],
        prompt: Mapping[str, Any],
        verify: Callable[[A], Rejection | None],
        with_picture: bool = False,
        pictures: tuple[Picture, ...] = (),
    ) -> Outcome[A]:
        """Ask, verify, ask again with the reasons.

        Args:
            kind: Of question; names the prompt's template.
            answer_type: What the answer must validate against.
            facts: For advisors without eyes.
            prompt: What the template's placeholders stand for.
            verify: Why an answer is refused, or None.
            with_picture: Whether a picture taken now goes with it.
            pictures: Taken before, that go with it too.
        """
        text, version = render(kind, prompt)
        if with_picture and self.pictures is not None:
            pictures = (*pictures, *self.pictures())
        question: Question[A] = Question(
            kind=kind, prompt=text, answer_type=answer_type, facts=facts, pictures=pictures, prompt_version=version
        )

        def observe(rejections: Sequence[Rejection]) -> Question[A]:
            return question

        def count(attempt: Attempt) -> None:
            self.calls += 1
            if self.log is not None:
                self.log(attempt)

        decision, self._decisions = self._decisions, self._decisions + 1
        # One loop for all questions: a model's connections live in the loop that opened them.
        self._loop = self._loop or asyncio.new_event_loop()
        return run_on(
            self._loop,
            consult(
                self.advisor,
                observe,
                lambda _, answer: verify(answer),
                self.budget,
                WallClock(),
                count,
                decision,
            ),
        )

    def close(self) -> None:
        """Close the advisor and the loop."""
        if self._loop is None:
            return
        if (aclose := getattr(self.advisor, "aclose", None)) is not None:
            run_on(self._loop, aclose())
        self._loop.close()
        self._loop = None
