"""Work that must never delay the control loop, such as writing files: a bounded queue and one thread."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable

from coral.errors import first_line

MOST_WAITING = 2000
"""Pieces of work that may wait: a disk that hangs for a minute at 10 Hz loses nothing."""


class BackgroundWork:
    """Does pieces of work in order, on a thread of its own. The caller never waits.

    When a piece fails, because the disk is full for instance, the work stops for good and `failure` says why: the
    vehicle keeps moving. When too much waits, new pieces are dropped and counted.
    """

    def __init__(self, most_waiting: int = MOST_WAITING, *, threaded: bool = True) -> None:
        """Start the thread; without `threaded` the work is done by `drain`, for tests."""
        self._queue: queue.Queue[Callable[[], None] | None] = queue.Queue(most_waiting)
        self.dropped = 0
        """Pieces that found the queue full."""
        self.done = 0
        """Pieces that were done, or failed."""
        self.failure = ""
        """Why the work stopped, or ""."""
        self._thread = threading.Thread(target=self._work, name="coral-background", daemon=True) if threaded else None
        if self._thread is not None:
            self._thread.start()

    def offer(self, work: Callable[[], None]) -> bool:
        """Take a piece of work, unless the queue is full or the work has stopped. Return whether it was taken."""
        if self.failure:
            return False
        try:
            self._queue.put_nowait(work)
        except queue.Full:
            self.dropped += 1
            return False
        return True

    def drain(self) -> None:
        """Do what waits, in the caller's thread; only without a thread of its own."""
        while not self._queue.empty():
            self._do(self._queue.get_nowait())

    def close(self, timeout_s: float = 20.0) -> bool:
        """Finish what waits and end the thread. Return whether it ended before a piece took longer than `timeout_s`."""
        if self._thread is None:
            self.drain()
            return True
        try:
            self._queue.put(None, timeout=timeout_s)
        except queue.Full:
            return False
        before = -1
        while self._thread.is_alive() and self.done > before:
            before = self.done
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def _work(self) -> None:
        while (work := self._queue.get()) is not None:
            self._do(work)

    def _do(self, work: Callable[[], None] | None) -> None:
        if work is None or self.failure:
            return
        try:
            work()
        except Exception as error:
            self.failure = first_line(error)
        self.done += 1
