"""How long the robots were in each of their states, from a run's events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def seconds_in_states(events: Sequence[Mapping[str, Any]], end_s: float) -> dict[str, float]:
    """Return the time (s) in each state, added up over the robots; empty if no states were recorded.

    Args:
        events: All events, in order; every robot begins ready, at time 0.
        end_s: End of the run (s).
    """
    changes = [event for event in events if event["event"] == "state"]
    total: dict[str, float] = {}
    for robot in sorted({int(event.get("robot", 0)) for event in changes}):
        state, since = "ready", 0.0
        for event in (change for change in changes if int(change.get("robot", 0)) == robot):
            total[state] = total.get(state, 0.0) + float(event["t"]) - since
            state, since = str(event["state"]), float(event["t"])
        total[state] = total.get(state, 0.0) + max(end_s - since, 0.0)
    return {state: round(seconds, 3) for state, seconds in total.items() if round(seconds, 3) > 0.0}


def clusters_left(events: Sequence[Mapping[str, Any]]) -> int | None:
    """Return the number of known clusters that were not finished; None where it was not recorded."""
    told = [event for event in events if event["event"] == "left"]
    return len(told[-1]["clusters"]) if told else None
