"""An advisor with the errors of real models, at known rates, for the verification experiments."""

from __future__ import annotations

import copy
import dataclasses
import json
import math
from collections.abc import Coroutine, Iterator, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from coral.advisor.parse import parse_answer
from coral.advisor.question import Advisor, AdvisorUnavailable, Question, Rejection, Reply, Usage
from coral.advisor.setting import Setting, read_probability
from coral.errors import InputError

A = TypeVar("A", bound=BaseModel)


KINDS = ("malformed", "empty", "wrong_type", "out_of_range", "backward", "stale", "refusal", "silence")
"""Kinds of error: truncated JSON; an empty reply; words instead of a number; an index or a number a thousand times too
large; a point behind the robot, a cluster that it has visited, or a number with the wrong sign; the choice of the
previous question, repeated; a polite refusal; no reply before the deadline."""


class FallibleAdvisor:
    """Passes on another advisor's answers and spoils some of them, each with one error of equally likely kinds.

    Spoilt answers go through the same parser as the text of a real model. The fault is recorded in the answer's usage,
    such as `spoilt-out-of-range`, for readers of the log; no decision uses it.
    """

    def __init__(
        self, inner: Advisor, probability: float, rng: np.random.Generator, kinds: Sequence[str] = KINDS
    ) -> None:
        """Wrap an advisor; `probability` is that of an error in an answer, of whatever kind."""
        self.inner, self._rng, self._kinds = inner, rng, kinds
        self._below = np.cumsum(np.full(len(kinds), probability / len(kinds)))
        self._previous: dict[str, dict[str, Any]] = {}
        self.name = f"fallible:{probability:g}:{inner.name}"

    def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Coroutine[Any, Any, Reply[A]]:
        """Answer, with an error at the configured rate.

        The error is drawn here, before the first await, so that an early cancellation does not shift the errors of
        later questions.

        Raises:
            BadAnswer: A spoilt answer does not validate, or the inner advisor raised it.
            AdvisorUnavailable: There is no reply; a simulated clock waits until the deadline.
        """
        hit = int(np.searchsorted(self._below, self._rng.random(), side="right"))
        seed = int(self._rng.integers(2**63))
        error = self._kinds[hit] if hit < len(self._kinds) else ""
        return self._answer(question, rejections, error, np.random.default_rng(seed))

    async def _answer(
        self, question: Question[A], rejections: Sequence[Rejection], error: str, rng: np.random.Generator
    ) -> Reply[A]:
        if error == "silence":
            raise AdvisorUnavailable(
                "silence",
                "the simulated model stayed silent",
                latency_s=math.inf,
                usage=Usage(requests=0, faults=("spoilt-silence",)),
            )
        reply = await self.inner.answer(question, rejections)
        right = reply.value.model_dump(mode="json")
        previous = self._previous.get(question.kind)
        self._previous[question.kind] = right
        if not error:
            return reply
        text = self._spoil(error, question, right, previous, rng)
        usage = dataclasses.replace(reply.usage, faults=(*reply.usage.faults, f"spoilt-{error.replace('_', '-')}"))
        return Reply(
            value=parse_answer(text, question.answer_type, usage), raw=text, usage=usage, latency_s=reply.latency_s
        )

    def _spoil(
        self,
        error: str,
        question: Question[Any],
        right: dict[str, Any],
        previous: dict[str, Any] | None,
        rng: np.random.Generator,
    ) -> str:
        """Return the text of a corrupted answer."""
        text = json.dumps(right)
        if error == "empty":
            return ""
        if error == "refusal":
            return "I'm sorry, but I can't help with that request."
        if error == "malformed":
            cut = int(rng.integers(1, max(2, len(text))))
            return text[: max(1, min(cut, len(text) - 2))]  # the last brace alone may be missing
        if error == "stale" and previous is not None:
            return json.dumps(previous)
        return json.dumps(spoil_number(error, right, question.facts, rng))


def spoil_number(
    error: str, right: Mapping[str, Any], facts: Mapping[str, Any], rng: np.random.Generator
) -> dict[str, Any]:
    """Return an answer with one of its numbers spoilt; without any number, it loses a field.

    The error is "wrong_type", "out_of_range", or something else for one that leads back: the `centroids` of the facts
    tell which were visited.
    """
    answer = copy.deepcopy(dict(right))
    places = list(_numbers(answer))
    if not places:
        del answer[next(iter(answer))]
        return answer
    ahead = [place for place in places if "forward" in str(place[1])]
    holder, key = (ahead or places)[int(rng.integers(len(ahead or places)))]
    value = holder[key]
    if error == "wrong_type":
        holder[key] = "two or three"
    elif error == "out_of_range":
        holder[key] = 1000 * (1 + abs(value))
    elif "index" in str(key):
        holder[key] = next((c["index"] for c in facts.get("centroids") or () if c.get("visited")), 0)
    else:
        holder[key] = -max(1, abs(value))
    return answer


def _numbers(value: Any) -> Iterator[tuple[Any, str | int]]:
    """Yield where the numbers of a JSON value are: what holds each, and its key there."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in pairs:
        if isinstance(item, int | float) and not isinstance(item, bool):
            yield value, key
        yield from _numbers(item)


def make_fallible(name: str, rest: str, setting: Setting) -> FallibleAdvisor:
    """Make an advisor with errors, fallible:P:INNER.

    Raises:
        InputError: P is not a probability, or there is no such inner advisor.
    """
    rate, _, inner = rest.partition(":")
    if not inner:
        found = repr(f"{name}:{rest}")
        raise InputError(setting.where, "", found, "fallible:P:INNER, such as fallible:0.3:heuristic")
    probability = read_probability(rate, "P", setting.where, "a probability from 0 to 1")
    return FallibleAdvisor(setting.inner(inner), probability, setting.rng)
