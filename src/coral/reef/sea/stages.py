"""Where the time of a control tick goes."""

from __future__ import annotations

import time
from collections.abc import Callable


class StageTimes:
    """A stopwatch with names: each `mark` ends a stage. Wall time of the stages, processor time of all together."""

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, processor: Callable[[], float] = time.thread_time
    ) -> None:
        """Set up; `processor` tells the processor time of the calling thread (s)."""
        self._clock, self._processor = clock, processor
        self._stages: dict[str, float] = {}
        self._last = self._used = 0.0

    def begin(self, **before_s: float) -> None:
        """Begin a tick; stages that were measured elsewhere may be given in seconds."""
        self._stages = dict(before_s)
        self._last, self._used = self._clock(), self._processor()

    def mark(self, stage: str) -> None:
        """End a stage."""
        now = self._clock()
        self._stages[stage] = self._stages.get(stage, 0.0) + now - self._last
        self._last = now

    def told_ms(self) -> dict[str, float]:
        """Return each stage in ms, and what the thread computed itself: the rest of the tick it had to wait."""
        told = {f"{name}_ms": round(1e3 * seconds, 1) for name, seconds in self._stages.items()}
        return told | {"computed_ms": round(1e3 * (self._processor() - self._used), 1)}
