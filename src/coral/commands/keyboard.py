"""The operator's terminal during a survey: keys, words on a pipe and signals, beside the thread of the control loop."""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from typing import IO, Any

from coral.errors import RunError
from coral.interrupts import SIGNALS, handling
from coral.reef.sea.operator import WORDS, OperatorWords, Word
from coral.reef.sea.sea_mission import SeaMission
from coral.run_loop import Observer
from coral.terminal import tell

KEYS: dict[str, Word] = {" ": "hold", "h": "hold", "r": "resume", "b": "home", "q": "stop", "s": "surface"}
"""Keys while the survey runs. Disarming has no key: it has to be written."""
HELP = "space: hold  r: resume  b: back to the start  s: surface  q: stop"
WAIT_S = 0.1
STOP_S = 5.0
"""Time for the work to end when the keyboard fails."""


class Keyboard:
    """Reads standard input without ever blocking for longer than `WAIT_S`."""

    def __init__(self, words: OperatorWords, source: IO[str] | None = None) -> None:
        """Listen, by default on standard input."""
        self._words, self._source = words, source or sys.stdin
        self._text, self._ended = "", False

    def listen(self, until: Callable[[], bool]) -> None:
        """Hand what is typed to the survey until it is over."""
        with self._single_keys() as keys:
            while not until():
                for letter in self._read():
                    self._take(letter, keys)

    def wait_for_arm(self) -> bool:
        """Wait until `arm` is typed, or said elsewhere; False when the operator gives up or the input ends.

        Whatever is said after `arm` takes it back.
        """
        while not self._ended:
            for letter in self._read():
                self._take(letter, keys=False)
            said = [word for word, _ in self._words.take()]
            if any(word in ("stop", "surface", "disarm") for word in said):
                return False
            if said and said[-1] == "arm":
                return True
            if said:
                tell("type arm to begin, q to give up")
        return False

    def _take(self, letter: str, keys: bool) -> None:
        if keys:
            if letter in KEYS:
                self._words.say(KEYS[letter], "keyboard")
        elif letter == "\n":
            line, self._text = self._text.strip(), ""
            word = next((word for word in WORDS if word == line.lower()), None) or KEYS.get(line.lower())
            if word is not None:
                self._words.say(word, "keyboard")
            elif line:
                tell(f"type {', '.join(WORDS)}; q is stop")
        else:
            self._text += letter

    def _read(self) -> str:
        if self._ended:
            select.select([], [], [], WAIT_S)
            return ""
        try:
            descriptor = self._source.fileno()
            if not select.select([descriptor], [], [], WAIT_S)[0]:
                return ""
            data = os.read(descriptor, 1024)
        except (OSError, ValueError):
            data = b""
        self._ended = not data
        return data.decode("utf-8", "replace")

    @contextmanager
    def _single_keys(self) -> Iterator[bool]:
        """Read keys one by one if the input is a terminal; yield whether it is."""
        try:
            import termios
            import tty

            descriptor = self._source.fileno()
            before = termios.tcgetattr(descriptor)
        except (ImportError, OSError, ValueError, AttributeError):
            yield False
            return
        except Exception as error:  # termios.error is no OSError
            if type(error).__name__ != "error":
                raise
            yield False
            return
        tty.setcbreak(descriptor)
        try:
            yield True
        finally:
            termios.tcsetattr(descriptor, termios.TCSADRAIN, before)


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
