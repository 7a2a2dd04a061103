"""Which thread does what during a survey: the loop on one of its own, keyboard and signals on the main one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from coral.commands.keyboard import Keyboard
from coral.errors import RunError
from coral.interrupts import SIGNALS, handling
from coral.reef.sea.operator import OperatorWords
from coral.reef.sea.priority import describe_priority, prefer_thread
from coral.reef.sea.sea_mission import SeaMission
from coral.run_loop import Observer


def conduct(
    mission: SeaMission, observers: Sequence[Observer[SeaMission]], words: OperatorWords, *, first: bool = False
) -> dict[str, Any]:
    """Run the control loop on a thread of its own; keyboard and signals stay here and never interrupt a tick.

    With `first`, the thread goes before all ordinary programs, where the system allows it.

    Raises:
        RunError: The loop failed; the vehicle was told to hold.
    """
    result: dict[str, Any] = {}
    failure: list[BaseException] = []

    def control() -> None:
        try:
            allowed = describe_priority(first, first and prefer_thread())
            result.update(mission.run(observers), priority=allowed)
        except BaseException as error:
            failure.append(error)

    thread = threading.Thread(target=control, name="coral-control", daemon=True)
    with signals_as_words(words):
        thread.start()
        Keyboard(words, instruct=mission.instructing).listen(lambda: not thread.is_alive())
        thread.join()
    if failure:
        raise RunError(f"the survey failed: {type(failure[0]).__name__}: {failure[0]}") from failure[0]
    return result


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
