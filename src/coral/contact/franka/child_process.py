"""A process beside the program that says when it is ready, or why it cannot be, and is ended with the program."""

from __future__ import annotations

import signal
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from typing import Any, TypeVar

from coral.errors import InputError, RunError

T = TypeVar("T")
START_TIMEOUT_S = 120.0
_END_S = 3.0


class ChildProcess:
    """Starts a process and waits until it is ready; `what` it is, errors say.

    `body` runs in it, with `args`, which can be pickled, and its end of the pipe; it says by `get_ready` that it is
    ready.

    Raises:
        InputError, RunError: It cannot become ready.
    """

    def __init__(self, what: str, body: Callable[..., None], args: tuple[Any, ...]) -> None:
        self._what = what
        self.connection, self._theirs = Pipe()
        spawn: Any = get_context("spawn").Process
        self.process = spawn(target=body, args=(*args, self._theirs), name=what, daemon=True)
        self.process.start()
        self.answer = self._await_start()
        """What the process told when it was ready."""

    def end(self) -> None:
        """Wait a little until it has ended, or kill it."""
        self.process.join(_END_S)
        if self.process.is_alive():
            self.process.kill()
            self.process.join(_END_S)

    def _await_start(self) -> Any:
        try:
            if not self.connection.poll(START_TIMEOUT_S):
                self.process.kill()
                raise RunError(f"{self._what} did not start within {START_TIMEOUT_S:.0f} s")
            kind, answer = self.connection.recv()
        except (EOFError, OSError):
            raise RunError(f"{self._what} could not be started") from None
        if kind == "ok":
            return answer
        self.process.join(_END_S)
        raise InputError(*answer) if kind == "input" else RunError(str(answer))


def get_ready(connection: Connection, prepare: Callable[[], T], answer: Callable[[T], Any] = lambda _: None) -> T:
    """Prepare in the process, and tell the program: what `answer` makes of it, or what went wrong.

    Raises:
        SystemExit: It went wrong; the process ends.
    """
    try:
        made = prepare()
    except InputError as error:
        connection.send(("input", (error.where, error.field, str(error.found), error.expected)))
    except Exception as error:
        text = str(error) if isinstance(error, RunError) else f"{type(error).__name__}: {error}"
        connection.send(("error", text))
    else:
        connection.send(("ok", answer(made)))
        return made
    raise SystemExit(1)


def leave_interrupts_to_the_program() -> None:
    """Ignore Ctrl-C in this process: the program says when it ends."""
    with suppress(ValueError):  # a thread in tests
        signal.signal(signal.SIGINT, signal.SIG_IGN)
