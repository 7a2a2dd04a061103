"""A thread that watches the inbox, and notifies waiting callers of changes."""

from __future__ import annotations

import threading

from coral.advisor.log import plain_json
from coral.desk.inbox import Inbox, entry_json

RECENT = 300
"""Number of questions that a page lists, the latest first."""


class InboxWatch:
    """The state of an inbox as JSON text, with a version that grows with every change."""

    def __init__(self, inbox: Inbox, period_s: float = 0.2) -> None:
        """Read the inbox once; `start` keeps it up to date.

        Args:
            inbox: The inbox to watch.
            period_s: Interval of reading (s).
        """
        self._inbox, self._period_s = inbox, period_s
        self._changed = threading.Condition()
        self._reading = threading.Lock()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="desk-watch", daemon=True)
        self._text, self._version = "", 0
        self.look()

    def start(self) -> None:
        """Poll the inbox on a separate thread."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread and release all waiting callers."""
        self._stop.set()
        with self._changed:
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join()

    def look(self) -> None:
        """Read the inbox now."""
        with self._reading:
            state = {
                "questions": [entry_json(entry) for entry in self._inbox.entries()[-RECENT:]],
                "missions": self._inbox.missions()[-8:],
            }
            text = plain_json(state)
            if text != self._text:
                with self._changed:
                    self._text, self._version = text, self._version + 1
                    self._changed.notify_all()

    def wait(self, seen: int, timeout_s: float) -> tuple[int, str]:
        """Wait until the version differs from `seen`, or until a time-out; return version and state.

        Raises:
            ConnectionAbortedError: The watch was stopped.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._version != seen or self._stop.is_set(), timeout_s)
            if self._stop.is_set():
                raise ConnectionAbortedError("the desk is closed")
            return self._version, self._text

    def _run(self) -> None:
        while not self._stop.wait(self._period_s):
            self.look()
