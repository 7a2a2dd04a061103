"""The operator's buttons on the viewer: pause, speed and stop of a run, weights of a cost, words of a survey at sea."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from coral.errors import InputError
from coral.view.records import is_number

if TYPE_CHECKING:
    from coral.contact.cost.stages import TermWeights
    from coral.reef.sea.operator import OperatorWords, Word

STOPPED = "stopped by the operator"
LOOK_S = 0.1
"""Longest time until a run that waits sees a change of its settings (s)."""
MOST = 4.0
"""Largest factor on a term of a cost."""
Panel = dict[str, Any]
Instruct = Callable[[str, str], bool]
"""instruct(words, by) changes the instruction of a mission in words; whether there is one."""


class Pace:
    """Pause, stop and speed, which the viewer sets from its own thread."""

    def __init__(
        self,
        speed: float = 0.0,
        *,
        clock: Callable[[], float] = time.monotonic,
        wait: Callable[[float], object] = time.sleep,
    ) -> None:
        self.speed = speed
        """Maximum simulated seconds per wall second; 0 for no limit."""
        self.paused = False
        self.stop = ""
        """Why the viewer ended the run, or ""."""
        self._clock, self._wait = clock, wait
        self._anchor: tuple[float, float, float] | None = None

    def end(self, reason: str = STOPPED) -> None:
        """Ask the run to end."""
        self.stop = self.stop or reason

    def stand_still(self) -> bool:
        """Wait until the run may continue; return whether it had to wait."""
        if not self.paused or self.stop:
            return False
        while self.paused and not self.stop:
            self._wait(LOOK_S)
        self._anchor = None
        return True

    def keep(self, t: float) -> None:
        """Wait until simulated time `t` (s) is due under the speed limit; a late run does not catch up."""
        while (speed := self.speed) and not self.paused and not self.stop:
            now = self._clock()
            if self._anchor is None or self._anchor[2] != speed:
                self._anchor = now, t, speed
            due = self._anchor[0] + (t - self._anchor[1]) / speed
            if now >= due:
                if now - due > 0.5:
                    self._anchor = now, t, speed
                return
            self._wait(min(due - now, LOOK_S))


class RunControls:
    """Pause, stop and speed of a mission or a task.

    `weights` takes a factor on each term of a cost, from the next plan on. The stop button calls `stop_now` besides, at
    once and from its own thread: it stops an arm. `instruct` changes the instruction. Each is None for a run without.
    """

    def __init__(
        self,
        pace: Pace,
        what: str = "mission",
        weights: TermWeights | None = None,
        stop_now: Callable[[], None] | None = None,
        instruct: Instruct | None = None,
    ) -> None:
        self.pace, self._what, self._weights, self._stop_now = pace, what, weights, stop_now
        self._instruct = instruct

    def panel(self, status: str) -> Panel:
        """Return the buttons."""
        ended = status.startswith("ended")
        pause = {"name": "pause", "label": "Resume" if self.pace.paused else "Pause", "disabled": ended}
        stop = {"name": "stop", "label": f"Stop the {self._what}", "tone": "bad", "disabled": ended}
        weighs = self._weights is not None and not ended
        buttons = [pause, stop, *([] if self._instruct is None else [_instruction_button(ended)])]
        return {"buttons": buttons, "speed": None if ended else self.pace.speed, "weights": weighs}

    def press(self, name: str, value: Any) -> bool:
        """Act on a button."""
        if name == "pause":
            self.pace.paused = not self.pace.paused
        elif name == "stop":
            if self._stop_now is not None:
                self._stop_now()
            self.pace.end()
        elif name == INSTRUCT:
            return _instructed(self._instruct, value)
        elif name == "speed" and is_number(value) and 0 <= value <= 1000:
            self.pace.speed = float(value)
        elif name == "weight" and isinstance(value, list) and len(value) == 3 and self._weights is not None:
            stage, term, factor = value
            if not (isinstance(stage, str) and isinstance(term, str) and is_number(factor)):
                return False
            self._weights.set(stage[:200], term[:200], min(max(float(factor), 0.0), MOST))
        else:
            return False
        return True


INSTRUCT = "instruct"


def _instruction_button(disabled: bool) -> Panel:
    hint = "The next question carries the new words; nobody judges words without known conditions."
    asks = "What the robot is to do"
    return {"name": INSTRUCT, "label": "Change the instruction", "hint": hint, "asks": asks, "disabled": disabled}


def _instructed(instruct: Instruct | None, words: object) -> bool:
    """Change the instruction; whether that could be done."""
    try:
        return instruct is not None and isinstance(words, str) and instruct(words, "page")
    except InputError:
        return False


BUTTONS: tuple[tuple[Word, str, str, str], ...] = (
    ("arm", "Arm and begin", "good", "The thrusters start, and the survey begins."),
    ("hold", "Hold", "", "Stay here. Resume continues."),
    ("resume", "Resume", "good", "Continue after a hold, a limit, or a person at the joystick."),
    ("home", "Return to the start", "", "Drives back around what is on the map; the survey ends there."),
    ("surface", "End and surface", "", "Ends the survey; the vehicle comes up where it is."),
    ("stop", "Stop the survey", "bad", "Ends the survey; the vehicle holds where it is."),
)
"""Word, label, tone and hint of each button."""


class SurveyControls:
    """The operator's words to a vehicle at sea; `instruct` changes the instruction, None for a survey without one."""

    def __init__(self, words: OperatorWords, instruct: Instruct | None = None) -> None:
        self._words, self._instruct = words, instruct

    def panel(self, status: str) -> Panel:
        """Return the buttons; disabled are those without meaning now: arming once under way, all after the end."""
        ended, waiting = status.startswith("ended"), status.startswith("preflight")
        made = [
            {"name": word, "label": label, "tone": tone, "hint": hint, "disabled": ended or (word == "arm") != waiting}
            for word, label, tone, hint in BUTTONS
        ]
        made += [] if self._instruct is None else [_instruction_button(ended)]
        return {"buttons": made, "speed": None, "weights": False}

    def press(self, name: str, value: Any) -> bool:
        """Say a word, or change the instruction."""
        if name == INSTRUCT:
            return _instructed(self._instruct, value)
        word = next((word for word, *_ in BUTTONS if word == name), None)
        if word is not None:
            self._words.say(word, "page")
        return word is not None
