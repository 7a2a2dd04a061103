"""Signals end a run in order: SIGTERM and SIGHUP as Ctrl-C does, and each between two steps, not in the middle of one.

Python raises an interrupt between any two instructions. In the middle of a control step it tears what the step was
about: a coroutine made but not awaited, a row half written.
"""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from types import FrameType
from typing import Any

from coral.terminal import tell

ENDING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
SIGNALS = (signal.SIGINT, *ENDING)

_Handler = Callable[[int, FrameType | None], Any]


@contextlib.contextmanager
def handling(handlers: Mapping[int, _Handler]) -> Iterator[None]:
    """Handle signals by number in this way until the block ends; only in the main thread, if there are any."""
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class _Gate:
    """Passes signals on to the handlers that were there before, or holds the first one back."""

    def __init__(self) -> None:
        self._handlers = {number: handler for number in SIGNALS if callable(handler := signal.getsignal(number))}
        self._held: tuple[int, FrameType | None] | None = None
        self.closed = False

    def handlers(self) -> dict[int, _Handler]:
        """Return what is to handle the signals that had a handler."""
        return dict.fromkeys(self._handlers, self.receive)

    def receive(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal: hold it back if the gate is closed and nothing is held yet; else pass it on."""
        if self.closed and self._held is None:
            self._held = number, frame
        else:
            self._handlers[number](number, frame)

    def open(self) -> None:
        """Pass on what was held back.

        Raises:
            KeyboardInterrupt: Raised by the handler of the signal.
        """
        self.closed = False
        held, self._held = self._held, None
        if held is not None:
            self._handlers[held[0]](*held)


_gate: _Gate | None = None


@contextlib.contextmanager
def holding_interrupts() -> Iterator[None]:
    """Allow the blocks of `uninterrupted` to hold signals back that have a handler, until this block ends.

    No effect outside the main thread, which alone receives signals, and inside another such block.
    """
    global _gate
    if _gate is not None or threading.current_thread() is not threading.main_thread():
        yield
        return
    gate = _Gate()
    with handling(gate.handlers()):
        _gate = gate
        try:
            yield
        finally:
            _gate = None


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold an interrupt back until the block ends; a second one acts at once.

    An error of the block takes precedence over an interrupt. Not to be nested.
    """
    gate = _here()
    if gate is None:
        yield
        return
    gate.closed = True
    try:
        yield
    except BaseException:
        gate.closed = False
        raise
    gate.open()


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """Let interrupts through while the block waits, inside `uninterrupted`.

    Raises:
        KeyboardInterrupt: One had been held back.
    """
    gate = _here()
    if gate is None or not gate.closed:
        yield
        return
    gate.open()
    try:
        yield
    finally:
        gate.closed = True


def _here() -> _Gate | None:
    """Return the gate, in the main thread only."""
    return _gate if threading.current_thread() is threading.main_thread() else None


def wait_for_interrupt(told: str = "") -> None:
    """Wait until Ctrl-C or SIGTERM, as told on standard error: a server that is told to stop has done its work."""
    with contextlib.suppress(KeyboardInterrupt), handling({signal.SIGTERM: signal.default_int_handler}):
        if told:
            tell(told)
        threading.Event().wait()


class Terminated(KeyboardInterrupt):
    """The process was asked to end; the text names the signal, as a run's end reason."""

    def __init__(self, number: int) -> None:
        super().__init__(f"stopped by {signal.Signals(number).name}")


@contextlib.contextmanager
def orderly_termination() -> Iterator[list[int]]:
    """Raise `Terminated` in the main thread at the first SIGTERM or SIGHUP, whose number is kept; ignore later ones.

    A signal with a handler is left alone: `nohup` ignores SIGHUP, a host program may have its own handler.
    """
    received: list[int] = []

    def end(number: int, frame: FrameType | None) -> None:
        if not received:
            received.append(number)
            raise Terminated(number)

    main = threading.current_thread() is threading.main_thread()
    ours = [number for number in ENDING if main and signal.getsignal(number) is signal.SIG_DFL]
    with handling(dict.fromkeys(ours, end)):
        yield received
