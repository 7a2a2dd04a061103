"""The clock of an outer-loop decision: simulated time passes while an advisor answers."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Callable, Coroutine
from typing import Any, Protocol, TypeVar

import numpy as np

from coral.advisor.latency import FORMS, LatencyCfg, default_latency, parse_latency
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Withdrawn
from coral.advisor.registry import asks_person
from coral.contact.scene.observation import Observation
from coral.errors import InputError

R = TypeVar("R")

VLM_S, LLM_S, REFINEMENT_S = 2.3, 1.5, 3.0
"""Latency of one answer in the CoRAL paper."""
PAPER_S = {
    "object-poses": VLM_S,
    "physical-parameters": VLM_S,
    "contact-regions": VLM_S,
    "unified": VLM_S,
    "cost-function": LLM_S,
    "cost-repair": REFINEMENT_S,
    "parameter-repair": REFINEMENT_S,
}
"""Latency `paper` (s) by kind of question; questions with a picture go to the paper's VLM."""
TINY_S = 1e-9


class Thinking(Protocol):
    """The part of an episode that continues while an advisor answers."""

    now: Observation
    """The latest observation."""

    @property
    def clock_s(self) -> float:
        """Return the simulated time (s) since the first question, all latencies included."""

    def go_on(self, seconds: float) -> bool:
        """Advance simulated time; return False if the episode ended meanwhile."""


class ThinkingClock:
    """Delivers each reply after its latency, during which the episode continues.

    It waits for the advisor first, then advances simulated time by the latency. The run does not depend on the machine
    unless the latency is measured.

    Without a latency, the paper's applies; without an episode, `thinking`, no time passes. An exception of the
    episode, while an advisor was answering, is its `fault`.
    """

    fault: Exception | None = None

    def __init__(self, latency: LatencyCfg | None, rng: np.random.Generator, thinking: Thinking | None = None) -> None:
        self.latency, self.thinking = latency, thinking
        self._rng = rng
        self._kind, self._wall_end_s = "", math.inf

    def begin(self, kind: str, wall_s: float) -> None:
        """Begin a decision."""
        self._kind, self._wall_end_s = kind, time.monotonic() + wall_s

    def now(self) -> float:
        """Return simulated seconds."""
        return 0.0 if self.thinking is None else self.thinking.clock_s

    async def reply(self, asking: Callable[[], Coroutine[Any, Any, R]], timeout_s: float) -> R:
        """Ask, and return the reply when it is due.

        Raises:
            TimeoutError: It did not come within `timeout_s` simulated seconds, or within the decision's wall time.
            Withdrawn: The episode ended meanwhile.
            BadAnswer, AdvisorUnavailable: Raised by the advisor; it takes the same latency as an answer.
        """
        # None if only the reply can tell it.
        drawn = PAPER_S.get(self._kind, LLM_S) if self.latency is None else self.latency.draw(self._rng)
        began = time.monotonic()
        error: BadAnswer | AdvisorUnavailable | None = None
        try:
            result = await asyncio.wait_for(asking(), max(self._wall_end_s - began, 0.0))
            said = getattr(result, "latency_s", None)
        except TimeoutError:
            self._pass_time(min(self._latency(drawn, None, began), timeout_s))
            raise
        except (BadAnswer, AdvisorUnavailable) as fault:
            error, said = fault, fault.latency_s
        latency_s = self._latency(drawn, said, began)
        if latency_s > timeout_s:
            self._pass_time(timeout_s if math.isfinite(latency_s) else 0.0)
            raise TimeoutError
        self._pass_time(latency_s)
        if error is not None:
            raise error
        return result

    def _latency(self, drawn: float | None, said: float | None, began: float) -> float:
        if drawn is not None:
            return drawn
        recorded = self.latency is not None and self.latency.kind == "recorded"
        return said if recorded and said is not None else time.monotonic() - began

    def _pass_time(self, seconds: float) -> None:
        try:
            over = seconds > TINY_S and self.thinking is not None and not self.thinking.go_on(seconds)
        except Exception as fault:  # of the episode; `consult` would blame the advisor
            self.fault = fault
            raise Withdrawn from None
        if over:
            raise Withdrawn


def thinking_latency(spec: str, advisor: Any, name: str) -> LatencyCfg | None:
    """Determine the latency of an advisor in simulated seconds; None for the paper's times by kind of question.

    "auto" is no time for rules, the measured time for models, the recorded time for recordings; for a person, simulated
    time stops. `name` is the advisor's, as on the command line.

    Raises:
        InputError: The latency has none of the known forms.
    """
    if spec == "paper":
        return None
    if spec != "auto":
        try:
            return parse_latency(spec)
        except InputError:
            raise InputError("--cfg", "think.latency", repr(spec), f"auto, paper, {FORMS}") from None
    return LatencyCfg(kind="fixed", median_s=0.0) if asks_person(name) else default_latency(advisor)
