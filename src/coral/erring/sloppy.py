"""An advisor with plausible errors at rates given by kind: its wrong answers look right, and most pass every check."""

from __future__ import annotations

import dataclasses
import json
from collections import deque
from collections.abc import Coroutine, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from coral.advisor.parse import parse_answer
from coral.advisor.question import Advisor, Question, Rejection, Reply
from coral.advisor.setting import Earlier, Mistake, Setting, read_probability
from coral.errors import InputError, nearest

A = TypeVar("A", bound=BaseModel)

FORM = "sloppy:P:INNER or sloppy:KIND=P+KIND=P:INNER, with probabilities from 0 to 1"
KEPT = 64
"""Number of remembered answers per kind of question."""


@dataclass(frozen=True, kw_only=True)
class Rates:
    """Error rates; a part of an answer has at most one mistake, and most answers have one part."""

    level: float | None = None
    """Probability that a part of any answer is wrong, divided equally among the mistakes possible there."""
    each: Mapping[str, float] = field(default_factory=dict)
    """Else the probability of each mistake, in answers to the questions in which it can happen."""

    def __str__(self) -> str:
        if self.level is not None:
            return f"{self.level:g}"
        return "+".join(f"{name}={rate:g}" for name, rate in self.each.items())


def parse_rates(text: str, mistakes: Sequence[Mistake], where: str = "--advisor") -> Rates:
    """Parse rates from the command line: `0.3`, or `mirrored=0.2+stale=0.1`.

    Raises:
        InputError: A kind is unknown, a rate is not a probability, or rates of one question sum to more than 1.
    """
    known = {mistake.name: mistake for mistake in mistakes}
    if not known:
        raise InputError(where, "sloppy", repr(text), "an application with plausible errors; this one has none")
    if "=" not in text:
        return Rates(level=read_probability(text, "P", where, FORM))
    each: dict[str, float] = {}
    for part in text.split("+"):
        name, _, rate = part.partition("=")
        if name not in known or name in each:
            found = repr(name) if name not in known else f"{name!r} twice"
            raise InputError(where, "sloppy", found, f"one of {', '.join(known)}{nearest(name, known)}")
        each[name] = read_probability(rate, name, where, FORM)
    for kind, part in sorted({(kind, mistake.part) for mistake in mistakes for kind in mistake.questions}):
        spoil = [name for name, mistake in known.items() if kind in mistake.questions and mistake.part == part]
        total = sum(rate for name, rate in each.items() if name in spoil)
        if total > 1.0 + 1e-9:
            raise InputError(where, "sloppy", f"rates that sum to {total:g} for {kind} questions", "at most 1")
    return Rates(each=each)


class SloppyAdvisor:
    """Passes on another advisor's answers, and puts a plausible error into some of them, or into parts of them.

    The error is recorded among the faults of the answer's usage, such as `sloppy-mirrored`, in `attempts.jsonl` and in
    the event of its verdict; no decision uses it. An error that is impossible in an answer is neither made nor logged.
    """

    def __init__(self, inner: Advisor, rates: Rates, rng: np.random.Generator, mistakes: Sequence[Mistake]) -> None:
        """Wrap an advisor."""
        self.inner, self._rates, self._rng, self._mistakes = inner, rates, rng, tuple(mistakes)
        self._past: dict[str, deque[Earlier]] = {}
        self.name = f"sloppy:{rates}:{inner.name}"

    def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Coroutine[Any, Any, Reply[A]]:
        """Answer, with a mistake at the configured rate.

        The error is drawn here, before the first await, so that an early cancellation does not shift the errors of
        later questions.

        Raises:
            BadAnswer, AdvisorUnavailable: Raised by the inner advisor.
        """
        able = [mistake for mistake in self._mistakes if question.kind in mistake.questions]
        chance, seed = float(self._rng.random()), int(self._rng.integers(2**63))
        rng = np.random.default_rng(seed)
        parts = [[one for one in able if one.part == part] for part in dict.fromkeys(one.part for one in able)]
        chosen = [
            self._choose_mistakes(each, chance if first else float(rng.random()), rng)
            for first, each in zip((True, *(False,) * len(parts)), parts, strict=False)
        ]
        return self._answer(question, rejections, chosen, rng)

    def _choose_mistakes(self, able: Sequence[Mistake], chance: float, rng: np.random.Generator) -> list[Mistake]:
        """Return the mistakes to try in turn, of those possible in a part of an answer; none for a right one."""
        if self._rates.level is not None:
            return [able[k] for k in rng.permutation(len(able))] if chance < self._rates.level else []
        below = 0.0
        for mistake in able:
            below += self._rates.each.get(mistake.name, 0.0)
            if chance < below:
                return [mistake]
        return []

    async def _answer(
        self,
        question: Question[A],
        rejections: Sequence[Rejection],
        tried: Sequence[Sequence[Mistake]],
        rng: np.random.Generator,
    ) -> Reply[A]:
        reply = await self.inner.answer(question, rejections)
        right = reply.value.model_dump(mode="json")
        past = self._past.setdefault(question.kind, deque(maxlen=KEPT))
        earlier = tuple(past)
        past.append(Earlier(at_s=question.asked_at_s, answer=right))
        given, faults = right, list(reply.usage.faults)
        for part in tried:
            for mistake in part:
                wrong = mistake.err(question, dict(given), earlier, rng)
                if wrong is None or wrong == given:
                    continue
                given = wrong
                faults.append(f"sloppy-{mistake.name}")
                break
        if given is right:
            return reply
        usage = dataclasses.replace(reply.usage, faults=tuple(faults))
        text = json.dumps(given)
        value = parse_answer(text, question.answer_type, usage)
        return Reply(value=value, raw=text, usage=usage, latency_s=reply.latency_s)


def make_sloppy(name: str, rest: str, setting: Setting) -> SloppyAdvisor:
    """Make an advisor with plausible errors, sloppy:ERRORS:INNER.

    Raises:
        InputError: The errors have the wrong form, or there is no such inner advisor.
    """
    errors, _, inner = rest.partition(":")
    if not inner:
        raise InputError(setting.where, "", repr(f"{name}:{rest}"), FORM)
    rates = parse_rates(errors, setting.mistakes, setting.where)
    return SloppyAdvisor(setting.inner(inner), rates, setting.rng, setting.mistakes)
