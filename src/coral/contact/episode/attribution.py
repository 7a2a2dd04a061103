"""Attribution of a contact episode's decisions, from its events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from coral.advisor.attribution import Attribution, Spent


def attribution_of(events: Iterable[Mapping[str, Any]]) -> Attribution:
    """Count the decisions of an episode by source.

    A decision is an event with the key `decided`: poses, parameters, plan, regions, repair, or an adopted correction.
    The decisions of one answer, or of one remembered plan, count once. A missing decision that ended the episode counts
    as the fallback's.
    """
    found = Attribution()
    for event in events:
        if event["event"] == "verdict":
            cost = Spent(*(event.get(name) for name in ("tokens_in", "tokens_out", "cost_usd")))
            found = found.heard(event["verdict"], cost, float(event.get("thinking_s", 0.0)))
        elif event.get("decided") is not None:
            found = found.decided(event["source"])
    return found
