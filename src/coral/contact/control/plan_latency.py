"""How late plans are: computing one takes time, and the robot moves on meanwhile."""

from __future__ import annotations

import math
from collections import deque
from statistics import median

from coral.errors import InputError

FORMS = "0, measured or fixed:SECONDS"
REMEMBERED = 25
"""Number of plans whose durations predict the next one's."""


class PlanLatency:
    """Counts a plan's duration in control steps, before it is computed and after.

    Args:
        spec: `0`: the world stands still while a plan is computed. `fixed:SECONDS`: every plan takes so long, whatever
            the machine. `measured`: as long as it takes here.
        step_s: Control period (s).
        least: Fewest control steps between plans.
        most: Control steps of a plan.

    Raises:
        InputError: The text is none of these, or no part of a plan would be left when it is ready.
    """

    def __init__(self, spec: str, step_s: float, least: int, most: int) -> None:
        self._step_s, self._least, self._most = step_s, least, most
        self._durations: deque[float] = deque(maxlen=REMEMBERED)
        self.fixed_s = _fixed(spec)
        if self.fixed_s is not None and self.fixed_s >= most * step_s:
            raise InputError("--cfg", "planning.latency", repr(spec), f"less than a plan's {most * step_s:g} s")

    @property
    def charged(self) -> bool:
        """Whether the world moves while a plan is computed."""
        return self.fixed_s != 0.0

    @property
    def plan_s(self) -> float:
        """Return how long a plan takes (s): as fixed, or the median so far; 0 if the world stands still."""
        if self.fixed_s is not None:
            return self.fixed_s
        return median(self._durations) if self._durations else 0.0

    def expected_steps(self) -> int:
        """Return the control steps until a plan that is begun now will be ready."""
        spare = 1.0 if self.fixed_s is not None else 1.1
        return max(self._least, self._steps(spare * self.plan_s))

    def taken_steps(self, seconds: float) -> int:
        """Return the control steps that pass until a plan that took `seconds` on this machine is ready."""
        if self.fixed_s is not None:
            return self.expected_steps()
        self._durations.append(seconds)
        return max(self._least, self._steps(seconds))

    def _steps(self, seconds: float) -> int:
        return min(math.ceil(seconds / self._step_s - 1e-9), self._most - 1)


def _fixed(spec: str) -> float | None:
    """Return the fixed latency (s); None if it is measured."""
    kind, _, number = spec.strip().partition(":")
    if kind == "measured" and not number:
        return None
    if kind == "fixed" or not number:
        try:
            seconds = float(number or kind)
        except ValueError:
            seconds = math.nan
        if 0.0 <= seconds < math.inf and (kind == "fixed" or seconds == 0.0):
            return seconds
    raise InputError("--cfg", "planning.latency", repr(spec), FORMS)
