"""What the operator reads on the terminal during a survey, printed off the control thread."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from coral.reef.sea.background import BackgroundWork
from coral.reef.sea.sea_mission import SeaMission
from coral.view.svg import clock

TOLD = ("state", "awaited", "alignment", "limit", "recording_stopped", "order_refused", "instruction")
"""Events that the operator is told of."""


@contextmanager
def survey_told(
    mission: SeaMission, say: Callable[[str], None], desk: Callable[[Mapping[str, Any]], None] | None = None
) -> Iterator[None]:
    """Say what happens to a survey, while it lasts; a terminal that hangs delays nothing else.

    Args:
        mission: The survey.
        say: Prints one line.
        desk: Tells the people who answer at the desk of an event.
    """
    work = BackgroundWork()

    def show(event: Mapping[str, Any], asked: str) -> None:
        for line in lines(event, asked):
            say(line)
        if desk is not None:
            desk(event)

    def hear(event: Mapping[str, Any]) -> None:
        if event["event"] in TOLD:
            asked = "" if mission.alignment is None else mission.alignment.status
            work.offer(lambda: show(event, asked))

    mission.record.listeners.append(hear)
    try:
        yield
    finally:
        work.close(2.0)


def lines(event: Mapping[str, Any], asked: str = "") -> list[str]:
    """Return what an event says to the operator.

    Args:
        event: One of the events in `TOLD`.
        asked: What the operator is asked about an alignment.
    """
    at, kind, reason = clock(float(event["t"])), event["event"], event.get("reason", "")
    if kind == "state":
        return [f"{at} {event['state']}: {reason}"]
    if kind == "instruction":
        return [f"{at} instruction, by {event['by']}: {event['text']}"]
    if kind == "awaited":
        return [f"{at}   {event['ends_when']}"] if event["ends_when"] else []
    if kind == "limit":
        return [f"{at} limit: {reason}; {event['action']}"]
    if kind == "recording_stopped":
        return [f"{at} the recording has stopped, the vehicle has not: {reason}"]
    if kind == "order_refused":
        return [f"{at} the vehicle refused {event['order']}: {reason}"]
    if event["status"] == "proposed":
        return [f"{at} {asked}", f"{at}   a: use it   n: go on without"]
    said = {
        "used": "the survey continues with the saved map",
        "unaligned": "the survey continues without the saved map",
    }
    text = said.get(event["status"], "no place on the saved map yet")
    return [f"{at} {text}: {reason}" if reason else f"{at} {text}"]
