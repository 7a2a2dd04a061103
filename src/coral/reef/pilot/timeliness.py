"""Whether questions could be answered well and answers came in time, from a mission's events (beyond the paper)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

LATE = "blocked"
"""Code of refusals for what the map showed when the answer came. A choice that was impossible when it was asked for has
it too, so that the count is an upper bound of what became true while waiting."""

DEFINITIONS = {
    "unanswerable": "Questions in which no choice on offer would have passed the checks.",
    "refused_late": "Answers refused for an obstacle that the present map shows: at most this many "
    "were refused for something that became true while the answer was awaited.",
    "overtaken": "Adopted clusters that the robot had seen from near by the time the answer came.",
}
"""Definitions of the metrics, for the report."""


def timeliness_of(events: Iterable[Mapping[str, Any]]) -> dict[str, int]:
    """Count questions without an acceptable choice, late refusals and overtaken goals of a mission."""
    found = dict.fromkeys(DEFINITIONS, 0)
    for event in events:
        kind = event["event"]
        if kind == "question":
            found["unanswerable"] += event.get("acceptable") == 0
        elif kind == "verdict":
            found["refused_late"] += event["verdict"] == "rejected" and event.get("code") == LATE
        elif kind == "goal":
            found["overtaken"] += bool(event.get("overtaken"))
    return found
