"""Attribution of a mission's decisions to their sources, from its events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from coral.advisor.attribution import Attribution, Spent


def attribution_of(events: Iterable[Mapping[str, Any]]) -> Attribution:
    """Count the decisions of each source in the events of a mission, or of one of its robots.

    A decision is a goal that was adopted (event `goal`), or kept because no new one was found (event `held`). The
    initial waypoint counts for no source. A withdrawn question, or one that found nothing left to explore, is no
    decision.
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
