"""The clock on which a contact task is thought about: simulated time goes on while an advisor answers."""

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
"""Time of one answer in the CoRAL paper."""
PAPER_S = {
    "object-poses": VLM_S,
    "physical-parameters": VLM_S,
    "contact-regions": VLM_S,
    "unified": VLM_S,
    "cost-function": LLM_S,
    "cost-repair": REFINEMENT_S,
    "parameter-repair": REFINEMENT_S,
}
"""Latency `paper` (s) by kind of question: who sees a picture is the paper's VLM."""
TINY_S = 1e-9


class Thinking(Protocol):
    """The episode, as far as thinking goes on in it."""

    now: Observation
    """What the sensors say."""

    @property
    def clock_s(self) -> float:
        """Simulated time (s) since the first question, all thinking included."""
        ...

    def go_on(self, seconds: float) -> bool:
        """Let so much simulated time pass; false where the episode ended meanwhile."""
        ...


class Frozen:
    """Simulated time that stands still, where there is no episode."""

    now: Observation
    clock_s = 0.0

    def go_on(self, seconds: float) -> bool:
        """Nothing happens."""
        return True


class ThinkingClock:
    """Delivers each reply after its latency, during which the episode goes on.

    The advisor is waited for first; then as much simulated time passes as its latency says. What follows does not
    depend on the machine unless the latency is measured.

    Args:
        latency: Of the replies; None for the paper's.
        rng: Drawn from where the latency is random.
        thinking: The episode.

    Attributes:
        fault: What went wrong in the episode while an advisor was thinking.
    """

    fault: Exception | None = None

    def __init__(self, latency: LatencyCfg | None, rng: np.random.Generator, thinking: Thinking | None = None) -> None:
        self.latency, self.thinking = latency, thinking or Frozen()
        self._rng = rng
        self._kind, self._wall_end_s = "", math.inf

    def begin(self, kind: str, wall_s: float) -> None:
        """Begin a decision.

        Args:
            kind: Of its questions.
            wall_s: Longest wall time that they may take.
        """
        self._kind, self._wall_end_s = kind, time.monotonic() + wall_s

    def now(self) -> float:
        """Simulated seconds."""
        return self.thinking.clock_s

    async def reply(self, asking: Callable[[], Coroutine[Any, Any, R]], timeout_s: float) -> R:
        """Ask, and return the reply when it is due.

        Raises:
            TimeoutError: It did not come within `timeout_s` simulated seconds, or within the decision's wall time.
            Withdrawn: The episode ended meanwhile.
            BadAnswer, AdvisorUnavailable: As the advisor raised it, after the same latency as an answer.
        """
        drawn = self._drawn()
        began = time.monotonic()
        error: BadAnswer | AdvisorUnavailable | None = None
        try:
            result = await asyncio.wait_for(asking(), max(self._wall_end_s - began, 0.0))
            said = getattr(result, "latency_s", None)
        except TimeoutError:
            self._pass(min(self._spent(drawn, None, began), timeout_s))
            raise
        except (BadAnswer, AdvisorUnavailable) as fault:
            error, said = fault, fault.latency_s
        latency_s = self._spent(drawn, said, began)
        if latency_s > timeout_s:
            self._pass(timeout_s if math.isfinite(latency_s) else 0.0)
            raise TimeoutError
        self._pass(latency_s)
        if error is not None:
            raise error
        return result

    def _drawn(self) -> float | None:
        """Latency of one question (s); None where only its reply can tell."""
        return PAPER_S.get(self._kind, LLM_S) if self.latency is None else self.latency.draw(self._rng)

    def _spent(self, drawn: float | None, said: float | None, began: float) -> float:
        if drawn is not None:
            return drawn
        recorded = self.latency is not None and self.latency.kind == "recorded"
        return said if recorded and said is not None else time.monotonic() - began

    def _pass(self, seconds: float) -> None:
        try:
            over = seconds > TINY_S and not self.thinking.go_on(seconds)
        except Exception as fault:  # of the episode: `consult` would take it for one of the advisor
            self.fault = fault
            raise Withdrawn from None
        if over:
            raise Withdrawn


def thinking_latency(spec: str, advisor: Any, name: str) -> LatencyCfg | None:
    """How long an advisor thinks in simulated seconds; None for the paper's times by kind of question.

    Args:
        spec: As configured. "auto": rules take no time, models as long as they do, recordings as long as was recorded;
            while a person answers, time stands still.
        advisor: Who is asked.
        name: Of the advisor, as on the command line.

    Raises:
        InputError: It is none of the known forms.
    """
    if spec == "paper":
        return None
    if spec != "auto":
        try:
            return parse_latency(spec)
        except InputError:
            raise InputError("--cfg", "think.latency", repr(spec), f"auto, paper, {FORMS}") from None
    return LatencyCfg(kind="fixed", median_s=0.0) if asks_person(name) else default_latency(advisor)
