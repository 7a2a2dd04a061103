"""Pause, stop and speed limit of a run, set from a page."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

STOPPED = "stopped by the operator"


class Pace:
    """Pause, stop and speed, set by the viewer. Every method may be called from any thread."""

    def __init__(
        self,
        speed: float = 0.0,
        *,
        clock: Callable[[], float] = time.monotonic,
        wait: Callable[[float], object] | None = None,
    ) -> None:
        """Start running at most at a speed, in simulated seconds per wall second; 0 for no limit.

        `wait` waits for at most so many seconds, less if a setting changes.
        """
        self._changed = threading.Event()
        self._clock = clock
        self._wait = wait or self._changed.wait
        self._speed = speed
        self._paused = False
        self.stop = ""
        """Why the viewer ended the run, or ""."""
        self._anchor: tuple[float, float] | None = None

    @property
    def paused(self) -> bool:
        """Return whether the run is paused."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._paused = paused
        self._change()

    @property
    def speed(self) -> float:
        """Return the maximum simulated seconds per wall second; 0 for no limit."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._speed = speed
        self._change()

    def end(self, reason: str = STOPPED) -> None:
        """Ask the run to end."""
        self.stop = self.stop or reason
        self._change()

    def stand_still(self) -> bool:
        """Wait until the run may continue; return whether it had to wait."""
        if not self._paused or self.stop:
            return False
        while self._paused and not self.stop:
            self._rest(0.1)
        self._anchor = None
        return True

    def keep(self, t: float) -> None:
        """Wait until simulated time `t` (s) is due under the speed limit; a late run does not catch up."""
        while self._speed and not self._paused and not self.stop:
            now = self._clock()
            if self._anchor is None:
                self._anchor = now, t
            due = self._anchor[0] + (t - self._anchor[1]) / self._speed
            if now >= due:
                if now - due > 0.5:
                    self._anchor = now, t
                return
            self._rest(min(due - now, 0.1))

    def _rest(self, seconds: float) -> None:
        self._wait(seconds)
        self._changed.clear()

    def _change(self) -> None:
        self._anchor = None
        self._changed.set()
