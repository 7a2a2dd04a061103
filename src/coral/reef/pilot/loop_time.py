"""Time for the pilot: that of the control loop's clock, without its jumps."""

from __future__ import annotations

import math

from coral.reef.pilot.checks import UnfitMeasurement, finite_numbers

PERIOD_S = 0.1
"""Assumed control period while the clock does not tell one."""
FARTHEST_S = 1e11
"""Times beyond this (s) are no times; it holds seconds, also since 1970."""


class LoopTime:
    """Follows a clock as long as it advances like one; over a jump it advances by one period."""

    def __init__(self, gap_s: float) -> None:
        """Set up; a step of more than `gap_s` (s), or backwards, is a jump."""
        self.t = 0.0
        """Time for the pilot (s). It never runs backwards; without jumps it is that of the clock."""
        self.clock: float | None = None
        """The clock's own time (s); None while it tells none."""
        self.offset = 0.0
        """Time for the pilot minus time of the clock (s)."""
        self._gap_s, self._period, self._started = gap_s, PERIOD_S, False

    def advance(self, clock: object) -> None:
        """Go to the next tick.

        Raises:
            UnfitMeasurement: The clock has jumped, by `detail`, or tells no time; time for the pilot went on.
        """
        before, self.clock = self.clock, None
        try:
            now = finite_numbers((clock,), 1)[0]
            if abs(now) > FARTHEST_S:
                raise UnfitMeasurement("no time", f"{now:g} s")
        except UnfitMeasurement:
            self.t += self._period if self._started else 0.0
            self._started = True
            raise
        self.clock = now
        step = now - before if before is not None else math.nan
        if not self._started:
            self.t = now
        elif 0.0 < step <= self._gap_s:
            self._period = step
            self.t = max(now + self.offset, self.t)
        else:
            self.t += self._period
            self.offset = self.t - now
        self._started = True
        if before is not None and not 0.0 < step <= self._gap_s:
            raise UnfitMeasurement("jumped", f"by {step:.2f} s")
