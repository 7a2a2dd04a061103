"""Who decided in a contact episode, from its events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from coral.advisor.attribution import Attribution, Spent


def attribution_of(events: Iterable[Mapping[str, Any]]) -> Attribution:
    """Counts over the events of an episode.

    A decision is an event with the key `decided`: poses, parameters, plan, regions, repair, or a correction that was
    believed. What one answer, or one memory, decides at once counts once. Where nobody decided and the episode ended
    for it, that counts as the fallback's.
    """
    found = Attribution()
    for event in events:
        if event["event"] == "verdict":
            cost = Spent(*(event.get(name) for name in ("tokens_in", "tokens_out", "cost_usd")))
            found = found.heard(event["verdict"], cost, float(event.get("thinking_s", 0.0)))
        elif event.get("decided") is not None:
            found = found.decided(event["source"])
    return found
