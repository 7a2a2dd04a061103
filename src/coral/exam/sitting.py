"""Putting each question of a set to an advisor once, and recording the replies."""

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


def sit(
    advisor: Advisor, items: Sequence[ExamItem], at_once: int = 1, told: Callable[[Sheet], None] = lambda sheet: None
) -> list[Sheet]:
    """Ask every question once; a bad answer is not asked for again.

    Args:
        advisor: The advisor; closed at the end.
        items: The questions.
        at_once: Maximum number of open questions.
        told: Receives each sheet when its reply has arrived.
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
    """Ask one question."""
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
