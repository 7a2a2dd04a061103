"""Attribution of a mission's decisions, from its events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from coral.advisor.attribution import Attribution, Spent


def attribution_of(events: Iterable[Mapping[str, Any]]) -> Attribution:
    """Count over the events of a mission, or over those of one of its robots.

    A decision is a goal that was adopted, or held because none could be (events `goal` and `held`). The initial
    waypoint is nobody's, and a question that was withdrawn, or that found nothing left to explore, decides nothing.
    """
    found = Attribution()
    for event in events:
        if event["event"] == "verdict":
            cost = Spent(*(event.get(name) for name in ("tokens_in", "tokens_out", "cost_usd")))
            t = float(event["t"])
            found = found.heard(event["verdict"], cost, t - float(event.get("asked_at", t)))
        elif event["event"] in ("goal", "held") and event.get("decision") is not None:
            found = found.decided(event["source"])
    return found
