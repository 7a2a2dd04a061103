"""Which thread does what during a survey: the loop on one of its own, keyboard and signals on the main one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from typing import Any

from coral.commands.keyboard import Keyboard
from coral.errors import RunError
from coral.interrupts import SIGNALS, handling
from coral.reef.sea.operator import OperatorWords
from coral.reef.sea.sea_mission import SeaMission
from coral.run_loop import Observer

STOP_S = 5.0
"""Time for the work to end when the keyboard fails."""


def conduct(mission: SeaMission, observers: Sequence[Observer[SeaMission]], words: OperatorWords) -> dict[str, Any]:
    """Run the control loop on a thread of its own; keyboard and signals stay here and never interrupt it.

    Raises:
        RunError: The loop failed; the vehicle was told to hold.
    """
    done: Future[dict[str, Any]] = Future()

    def control() -> None:
        try:
            done.set_result(mission.run(observers))
        except BaseException as error:
            done.set_exception(error)

    thread = threading.Thread(target=control, name="coral-control", daemon=True)
    try:
        with signals_as_words(words):
            thread.start()
            try:
                Keyboard(words).listen(done.done)
            except BaseException:
                words.say("stop", "failure")  # nothing may command the vehicle after the program has ended
                thread.join(STOP_S)
                raise
        return done.result()
    except Exception as error:
        raise RunError(f"the survey failed: {type(error).__name__}: {error}") from error


@contextmanager
def signals_as_words(words: OperatorWords) -> Iterator[None]:
    """Let Ctrl-C, SIGTERM and SIGHUP stop the survey in order: the vehicle holds before the program ends."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: handler for number in SIGNALS if (handler := signal.getsignal(number)) is not signal.SIG_IGN}

    def stop(number: int, _: object) -> None:
        words.say("stop", signal.Signals(number).name)
        handler = before[number]
        if number != signal.SIGINT and callable(handler):
            with suppress(KeyboardInterrupt):
                handler(number, None)  # notes the signal for the exit code

    with handling(dict.fromkeys(before, stop)):
        yield
