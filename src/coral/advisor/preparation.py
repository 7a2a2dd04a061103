"""The thread on which questions are prepared, so that the control loop never waits for pictures or plans."""

from __future__ import annotations

import sys
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

R = TypeVar("R")

SWITCH_S = 0.0005
"""Longest time for which a thread that wants the interpreter waits for another one; Python's default is ten times as
long, and a control tick asks for it several times."""


class PreparationThread:
    """Runs one piece of work after the other; the thread starts with the first one."""

    def __init__(self) -> None:
        self._executor: ThreadPoolExecutor | None = None

    def submit(self, work: Callable[[], R]) -> Future[R]:
        """Run `work` on the thread."""
        if self._executor is None:
            sys.setswitchinterval(min(SWITCH_S, sys.getswitchinterval()))
            self._executor = ThreadPoolExecutor(1, "coral-preparation")
        return self._executor.submit(work)

    def close(self) -> None:
        """Finish the work under way, and drop what has not begun."""
        if self._executor is not None:
            self._executor.shutdown(cancel_futures=True)
            self._executor = None
