"""What the operator reads on the terminal during a survey, printed off the control thread."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from coral.reef.mission.events import place_told, sight_told
from coral.reef.sea.background import BackgroundWork
from coral.reef.sea.sea_mission import SeaMission
from coral.words import clock

TOLD: dict[str, Callable[[Mapping[str, Any]], str]] = {
    "state": lambda event: f"{event['state']}: {event['reason']}",
    "awaited": lambda event: f"  {event['ends_when']}" if event["ends_when"] else "",
    "limit": lambda event: f"limit: {event['reason']}; {event['action']}",
    "recording_stopped": lambda event: f"the recording has stopped, the vehicle has not: {event['reason']}",
    "order_refused": lambda event: f"the vehicle refused {event['order']}: {event['reason']}",
    "instruction": lambda event: f"instruction, by {event['by']}: {event['text']}",
    "place": lambda event: f"saved map: {place_told(event)}",
    "planner_failure": lambda event: (
        f"stands, {event['reason']}: drive it free by hand (in another mode), then type r; or q ends the survey"
    ),
    "sight": sight_told,
}
"""Events that the operator is told of, and in which words; "" for nothing."""
FENCED_S = 20.0
"""Without a safe motion for this long, the vehicle does not get away by itself soon; said again after each minute."""

LENS_S = 60.0
"""By then the pictures mostly tell whether they are of the stated lens, and little is lost with a wrong one."""


class _Fenced:
    """Picks, of the failures to find a safe motion, which come at every tick, those that are worth a line."""

    def __init__(self) -> None:
        self._last = self._said = -math.inf
        self._since = 0.0

    def worth_a_line(self, t: float) -> bool:
        if t - self._last > 1.0:
            self._since, self._said = t, -math.inf
        self._last = t
        if t - self._since < FENCED_S or t - self._said < 60.0:
            return False
        self._said = t
        return True


@contextmanager
def survey_told(
    mission: SeaMission, say: Callable[[str], None], desk: Callable[[Mapping[str, Any]], None] | None = None
) -> Iterator[None]:
    """Say what happens to a survey, while it lasts; a terminal that hangs delays nothing else.

    `desk` tells the people who answer at the desk of an event.
    """
    work, fenced = BackgroundWork(), _Fenced()

    def show(event: Mapping[str, Any]) -> None:
        if line := told(event):
            say(line)
        if desk is not None:
            desk(event)

    def hear(event: Mapping[str, Any]) -> None:
        if event["event"] in TOLD and (event["event"] != "planner_failure" or fenced.worth_a_line(float(event["t"]))):
            work.offer(lambda: show(event))

    mission.record.listeners.append(hear)
    try:
        yield
    finally:
        work.close(2.0)


@contextmanager
def lens_told(
    folder: Path, say: Callable[[str], None], check: Callable[[Path], str], after_s: float = LENS_S
) -> Iterator[None]:
    """Say, a while after the beginning, what the check of the lens finds in the run so far; in a process of its own."""
    ended = threading.Event()

    def look() -> None:
        if ended.wait(after_s):
            return
        with (
            suppress(Exception),  # the check comes again after the survey
            ProcessPoolExecutor(1, get_context("spawn"), os.nice, (19,)) as process,
        ):
            if line := process.submit(check, folder).result():
                say(line)

    threading.Thread(target=look, name="coral-lens", daemon=True).start()
    try:
        yield
    finally:
        ended.set()


def told(event: Mapping[str, Any]) -> str:
    """Return what one of the events in `TOLD` says to the operator; "" for nothing."""
    text = TOLD[event["event"]](event)
    return text and f"{clock(float(event['t']))} {text}"
