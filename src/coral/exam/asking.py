"""Putting each question of a set to an advisor once, and recording the replies."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from coral.advisor.consult import Attempt, BudgetCfg, consult
from coral.advisor.question import Advisor, BadAnswer, Usage, trait
from coral.exam.item import ExamItem


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """The reply to one question, or why there is none."""

    item: ExamItem
    """The question."""
    answer: BaseModel | None
    """The validated answer; None if there is none."""
    raw: str = ""
    """The reply as text."""
    failure: str = ""
    """Code and message if there is no answer, else ""."""
    seconds: float | None = None
    """Latency, by wall time or as a recording states it; None if unknown."""
    usage: Usage = field(default_factory=lambda: Usage(requests=0))
    """Tokens and cost."""


def ask_all(advisor: Advisor, items: Sequence[ExamItem], at_once: int = 1) -> list[Sheet]:
    """Ask every question once; a bad answer is not asked for again.

    Args:
        advisor: The advisor; closed at the end.
        items: The questions.
        at_once: Maximum number of open questions.
    """
    return asyncio.run(_gather(advisor, items, at_once))


async def _gather(advisor: Advisor, items: Sequence[ExamItem], at_once: int) -> list[Sheet]:
    gate = asyncio.Semaphore(at_once)

    async def one(item: ExamItem) -> Sheet:
        async with gate:
            return await ask(advisor, item)

    try:
        return list(await asyncio.gather(*(one(item) for item in items)))
    finally:
        if (aclose := trait(advisor, "aclose")) is not None:
            await aclose()


async def ask(advisor: Advisor, item: ExamItem) -> Sheet:
    """Ask one question."""
    log: list[Attempt] = []
    budget, clock = BudgetCfg(max_requeries=0), _Stopwatch(item.asked_at_s)
    outcome = await consult(
        advisor, lambda _: item.question(), lambda question, answer: None, budget, clock, log.append
    )
    (asked,) = log
    said = asked.rejection
    return Sheet(
        item=item,
        answer=outcome.answer,
        raw=asked.raw,
        failure="" if said is None else f"{said.code}: {said.reason}",
        seconds=None if asked.verdict == "unavailable" else asked.answered_at_s - asked.asked_at_s,
        usage=asked.usage,
    )


class _Stopwatch:
    """A clock that passes by the time of each reply, as measured or as a recording states it, and knows no deadline."""

    def __init__(self, start_s: float) -> None:
        self._now_s = start_s

    def now(self) -> float:
        return self._now_s

    async def reply(self, asking: Callable[[], Any], timeout_s: float) -> Any:
        began_s, known_s = time.perf_counter(), None
        try:
            reply = await asking()
            known_s = reply.latency_s
            return reply
        except BadAnswer as bad:
            known_s = bad.latency_s
            raise
        finally:
            self._now_s += time.perf_counter() - began_s if known_s is None else known_s
