"""Putting a set of questions to an advisor, each once, and keeping what came back."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from coral.advisor.question import Advisor, AdvisorUnavailable, BadAnswer, Usage
from coral.exam.item import ExamItem


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """What came back for one question."""

    item: ExamItem
    """The question."""
    answer: BaseModel | None
    """What validated; None where nothing did."""
    raw: str = ""
    """The reply as text."""
    failure: str = ""
    """Why there is no answer: a code and words; "" where there is one."""
    seconds: float | None = None
    """From question to reply, wall time or what a recording says; None where nobody knows."""
    usage: Usage = field(default_factory=lambda: Usage(requests=0))
    """Tokens and cost."""


def sit(
    advisor: Advisor, items: Sequence[ExamItem], at_once: int = 1, told: Callable[[Sheet], None] = lambda sheet: None
) -> list[Sheet]:
    """Ask every question once; nothing is asked again, whatever the answer.

    Args:
        advisor: Who is asked; closed at the end.
        items: The questions.
        at_once: How many may be open at a time.
        told: Receives each sheet as it comes.
    """
    return asyncio.run(_sit(advisor, items, at_once, told))


async def _sit(advisor: Advisor, items: Sequence[ExamItem], at_once: int, told: Callable[[Sheet], None]) -> list[Sheet]:
    gate = asyncio.Semaphore(at_once)

    async def one(item: ExamItem) -> Sheet:
        async with gate:
            sheet = await ask(advisor, item)
            told(sheet)
            return sheet

    try:
        return list(await asyncio.gather(*(one(item) for item in items)))
    finally:
        if (aclose := getattr(advisor, "aclose", None)) is not None:
            await aclose()


async def ask(advisor: Advisor, item: ExamItem) -> Sheet:
    """Put one question."""
    began = time.perf_counter()

    def seconds(known: float | None) -> float:
        return time.perf_counter() - began if known is None else known

    known: dict[str, Any]
    try:
        reply = await advisor.answer(item.question(), ())
    except BadAnswer as bad:
        failure = f"{bad.rejection.code}: {bad.rejection.reason}"
        known = {"raw": bad.raw, "failure": failure, "seconds": seconds(bad.latency_s), "usage": bad.usage}
        return Sheet(item=item, answer=None, **known)
    except AdvisorUnavailable as gone:
        return Sheet(item=item, answer=None, failure=f"{gone.code}: {gone.reason}", usage=gone.usage)
    return Sheet(item=item, answer=reply.value, raw=reply.raw, seconds=seconds(reply.latency_s), usage=reply.usage)
