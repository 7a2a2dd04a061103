"""An advisor with errors at rates given by kind: wrong answers that look right, and replies that are no answer."""

from __future__ import annotations

import dataclasses
import json
import math
from collections import deque
from collections.abc import Coroutine, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from coral.advisor.parse import parse_answer
from coral.advisor.question import Advisor, AdvisorUnavailable, Question, Rejection, Reply, Usage
from coral.advisor.setting import Answer, Earlier, Mistake, Setting
from coral.errors import InputError, nearest

A = TypeVar("A", bound=BaseModel)

FORM = "sloppy:P:INNER or sloppy:KIND=P+KIND=P:INNER, with probabilities from 0 to 1"
SORRY = "I'm sorry, but I can't help with that request."
KEPT = 64
"""Number of remembered answers per kind of question."""


def _cut(question: Question[Any], right: Answer, earlier: Sequence[Earlier], rng: np.random.Generator) -> str:
    """Stop in the middle; the last brace alone may be missing."""
    text = json.dumps(right)
    return text[: int(rng.integers(1, max(2, len(text) - 1)))]


def _stay_silent(*_: Any) -> str:
    usage = Usage(requests=0, faults=("sloppy-silence",))
    raise AdvisorUnavailable("silence", "the simulated model stayed silent", latency_s=math.inf, usage=usage)


NO_ANSWERS = (
    Mistake(name="malformed", what="the text stops in the middle", found_in="", questions=(), err=_cut),
    Mistake(name="refusal", what="a polite refusal", found_in="", questions=(), err=lambda *_: SORRY),
    Mistake(name="silence", what="no reply before the deadline", found_in="", questions=(), err=_stay_silent),
)
"""Replies to any question that are no answer, made only where they are named."""


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
    """Parse rates from the command line: `0.3`, or `mirrored=0.2+malformed=0.1`.

    Raises:
        InputError: A kind is unknown, a rate is not a probability, or rates of one question sum to more than 1.
    """
    if "=" not in text:
        if not mistakes:
            raise InputError(where, "sloppy", repr(text), "an application with plausible errors; this one has none")
        return Rates(level=_read_probability(text, "P", where))
    known = {mistake.name: mistake for mistake in (*mistakes, *NO_ANSWERS)}
    each: dict[str, float] = {}
    for part in text.split("+"):
        name, _, rate = part.partition("=")
        if name not in known or name in each:
            found = repr(name) if name not in known else f"{name!r} twice"
            raise InputError(where, "sloppy", found, f"one of {', '.join(known)}{nearest(name, known)}")
        each[name] = _read_probability(rate, name, where)
    for kind, part in sorted({(kind, one.part) for one in known.values() for kind in one.questions or ("all",)}):
        beside = [name for name, one in known.items() if one.part == part and kind in (one.questions or (kind,))]
        total = sum(rate for name, rate in each.items() if name in beside)
        if total > 1.0 + 1e-9:
            raise InputError(where, "sloppy", f"rates that sum to {total:g} for {kind} questions", "at most 1")
    return Rates(each=each)


def _read_probability(text: str, name: str, where: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = -1.0
    if not 0.0 <= rate <= 1.0:
        raise InputError(where, name, repr(text), FORM)
    return rate


class SloppyAdvisor:
    """Passes on another advisor's answers, and puts an error into some of them, or into parts of them.

    The error is recorded among the faults of the answer's usage, such as `sloppy-mirrored`, in `attempts.jsonl` and in
    the event of its verdict; no decision uses it. An error that is impossible in an answer is neither made nor logged.
    """

    def __init__(self, inner: Advisor, rates: Rates, rng: np.random.Generator, mistakes: Sequence[Mistake]) -> None:
        """Wrap an advisor."""
        self.inner, self._rates, self._rng = inner, rates, rng
        self._mistakes = (*mistakes, *(one for one in NO_ANSWERS if one.name in rates.each))
        self._past: dict[str, deque[Earlier]] = {}
        self.name = f"sloppy:{rates}:{inner.name}"

    def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Coroutine[Any, Any, Reply[A]]:
        """Answer, with a mistake at the configured rate.

        The error is drawn here, before the first await, so that an early cancellation does not shift the errors of
        later questions.

        Raises:
            BadAnswer: The reply is spoilt so that it is no answer, or the inner advisor raised it.
            AdvisorUnavailable: Silence, which lasts until the deadline, or raised by the inner advisor.
        """
        able = [one for one in self._mistakes if not one.questions or question.kind in one.questions]
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
        if any(mistake.err is _stay_silent for part in tried for mistake in part):
            _stay_silent()  # nobody is asked, or his answer would have to be paid
        reply = await self.inner.answer(question, rejections)
        right = reply.value.model_dump(mode="json")
        past = self._past.setdefault(question.kind, deque(maxlen=KEPT))
        earlier = tuple(past)
        past.append(Earlier(at_s=question.asked_at_s, answer=right))
        given, text, faults = right, "", list(reply.usage.faults)
        for part in tried:
            for mistake in part:
                wrong = mistake.err(question, dict(given), earlier, rng)
                if wrong is None or wrong == given:
                    continue
                if isinstance(wrong, str):
                    text = wrong
                else:
                    given = wrong
                faults.append(f"sloppy-{mistake.name}")
                break
        if given is right and not text:
            return reply
        usage = dataclasses.replace(reply.usage, faults=tuple(faults))
        text = text or json.dumps(given)
        value = parse_answer(text, question.answer_type, usage)
        return Reply(value=value, raw=text, usage=usage, latency_s=reply.latency_s)


def make_sloppy(name: str, rest: str, setting: Setting) -> SloppyAdvisor:
    """Make an advisor with errors, sloppy:ERRORS:INNER.

    Raises:
        InputError: The errors have the wrong form, or there is no such inner advisor.
    """
    errors, _, inner = rest.partition(":")
    if not inner:
        raise InputError(setting.where, "", repr(f"{name}:{rest}"), FORM)
    rates = parse_rates(errors, setting.mistakes, setting.where)
    return SloppyAdvisor(setting.inner(inner), rates, setting.rng, setting.mistakes)
