"""SIGTERM and SIGHUP end a command in the same way as Ctrl-C: it stops in order and writes its results."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType

from coral.exit_code import ExitCode

SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))


class Terminated(KeyboardInterrupt):
    """The process was asked to end; the text names the signal, as a run's end reason."""

    def __init__(self, number: int) -> None:
        super().__init__(f"stopped by {signal.Signals(number).name}")


@dataclass
class Received:
    """The signal that ended the command."""

    number: int = 0
    """0 without a signal."""

    def exit_code(self, code: int) -> int:
        """Return `ExitCode.SIGNALLED` plus the number of the signal, as in shells; `code` without a signal."""
        return ExitCode.SIGNALLED + self.number if self.number else code


@contextlib.contextmanager
def orderly_termination() -> Iterator[Received]:
    """Raise `Terminated` in the main thread at the first SIGTERM or SIGHUP; ignore later ones.

    A signal with a handler is left alone: `nohup` ignores SIGHUP, a host program may have its own handler.
    """
    received = Received()

    def end(number: int, frame: FrameType | None) -> None:
        if not received.number:
            received.number = number
            raise Terminated(number)

    main = threading.current_thread() is threading.main_thread()
    ours = [number for number in SIGNALS if main and signal.getsignal(number) is signal.SIG_DFL]
    for number in ours:
        signal.signal(number, end)
    try:
        yield received
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)
