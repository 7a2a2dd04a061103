"""What events of a survey say, in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any


def sight_told(event: Mapping[str, Any]) -> str:
    """Return what the event `sight` says, in words."""
    if unjudged(event):
        return "the eyes judge nothing here: what they see is unlike all that they have learned, or too murky"
    return f"the eyes tell oysters from sea floor up to {event['reach_m']:.1f} m away"


def guesses_told(events: Sequence[Mapping[str, Any]]) -> str:
    """Return what the events `guess` say of an advisor's guesses, in words; "" without any."""
    right = sum(bool(event["hit"]) for event in events)
    return f"of {len(events)} guesses of its advisor that the robot looked at, {right} proved right" if events else ""


def unjudged(event: Mapping[str, Any]) -> bool:
    """Whether by an event `sight` no oyster would be told from sea floor, however near."""
    return round(float(event["reach_m"]), 1) <= 0.0


def place_told(event: Mapping[str, Any]) -> str:
    """Return what the event `place` says, in words."""
    if not event["recognised"]:
        return f"none of {event['landmarks']} landmarks recognised - is this the place? The pose is not corrected by it"
    off = f"{math.hypot(event['x'], event['y']):.2f} m and {abs(math.degrees(event['theta'])):.0f} degrees"
    return f"{event['recognised']} of {event['landmarks']} landmarks recognised, odometry off by {off}"
