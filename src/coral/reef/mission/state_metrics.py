"""How long the vehicle was in each of its states, from a run's events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def seconds_in_states(events: Sequence[Mapping[str, Any]], end_s: float) -> dict[str, float]:
    """Return the time (s) in each state; empty if no states were recorded.

    Args:
        events: All events, in order; the vehicle begins ready, at time 0.
        end_s: End of the run (s).
    """
    changes = [event for event in events if event["event"] == "state"]
    if not changes:
        return {}
    total: dict[str, float] = {}
    state, since = "ready", 0.0
    for change in changes:
        total[state] = total.get(state, 0.0) + float(change["t"]) - since
        state, since = str(change["state"]), float(change["t"])
    total[state] = total.get(state, 0.0) + max(end_s - since, 0.0)
    return {state: round(seconds, 3) for state, seconds in total.items() if round(seconds, 3) > 0.0}


def clusters_left(events: Sequence[Mapping[str, Any]]) -> int | None:
    """Return the number of known clusters that were not finished; None where it was not recorded."""
    told = [event for event in events if event["event"] == "left"]
    return len(told[-1]["clusters"]) if told else None
