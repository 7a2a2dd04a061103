"""Pause, stop and speed limit of a run, set from a page."""

from __future__ import annotations

import time
from collections.abc import Callable

STOPPED = "stopped by the operator"
LOOK_S = 0.1
"""Longest time until a run that waits sees a change of its settings (s)."""


class Pace:
    """Pause, stop and speed, which the viewer sets from its own thread."""

    def __init__(
        self,
        speed: float = 0.0,
        *,
        clock: Callable[[], float] = time.monotonic,
        wait: Callable[[float], object] = time.sleep,
    ) -> None:
        self.speed = speed
        """Maximum simulated seconds per wall second; 0 for no limit."""
        self.paused = False
        self.stop = ""
        """Why the viewer ended the run, or ""."""
        self._clock, self._wait = clock, wait
        self._anchor: tuple[float, float, float] | None = None

    def end(self, reason: str = STOPPED) -> None:
        """Ask the run to end."""
        self.stop = self.stop or reason

    def stand_still(self) -> bool:
        """Wait until the run may continue; return whether it had to wait."""
        if not self.paused or self.stop:
            return False
        while self.paused and not self.stop:
            self._wait(LOOK_S)
        self._anchor = None
        return True

    def keep(self, t: float) -> None:
        """Wait until simulated time `t` (s) is due under the speed limit; a late run does not catch up."""
        while (speed := self.speed) and not self.paused and not self.stop:
            now = self._clock()
            if self._anchor is None or self._anchor[2] != speed:
                self._anchor = now, t, speed
            due = self._anchor[0] + (t - self._anchor[1]) / speed
            if now >= due:
                if now - due > 0.5:
                    self._anchor = now, t, speed
                return
            self._wait(min(due - now, LOOK_S))
