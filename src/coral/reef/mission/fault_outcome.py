"""What a vehicle did about a fault of its sensors, from the record of the run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coral.reef.simulation.faults import SensorFault

STANDS_M_S = 0.05
"""Speed over ground below which the vehicle stands still."""


@dataclass(frozen=True, kw_only=True)
class FaultOutcome:
    """The vehicle's answer to one fault. Times count from the fault's beginning unless it says otherwise."""

    fault: str
    said: str
    """Reason in the record: of the hold, or else of what was refused; "" if nothing was noticed."""
    held_after_s: float | None
    """Until the vehicle was held; None if it drove on."""
    stopped_after_s: float | None
    """Until it stood still, by its true speed."""
    driven_m: float
    """Way driven until it stood still, or until the fault was over."""
    back_after_s: float | None
    """From the end of the fault until it surveyed again; None if it was never held, or held to the end."""
    collisions: int


def outcome_of(
    fault: SensorFault, events: Sequence[Mapping[str, Any]], rows: Iterable[Mapping[str, str]]
) -> FaultOutcome:
    """Measure what followed a fault.

    Args:
        fault: The fault, the only one of the run.
        events: All events of a robot that is alone, in order.
        rows: The rows of its trajectory, in order.
    """
    start, end = fault.start_s, fault.start_s + fault.duration_s
    after = [event for event in events if float(event["t"]) >= start - 1e-9]
    states = [event for event in after if event["event"] == "state"]
    held = next((event for event in states if event["state"] == "holding"), None)
    refused = next((event for event in after if event["event"] == "sensor" and event["refused"]), None)
    back = next((event for event in states if held and event["state"] == "surveying"), None)
    driven, stopped, last = 0.0, None, None
    for row in rows:
        t, here = float(row["t"]), (float(row["x"]), float(row["y"]))
        if last is not None and start + 1e-9 < t <= end + 1e-9 and stopped is None:
            driven += math.dist(last, here)
            speed = math.hypot(float(row["u"]), float(row["v"]))
            if held is not None and t > float(held["t"]) and speed < STANDS_M_S:
                stopped = t - start
        last = here
    said = str(held["reason"]) if held else f"{refused['input']} {refused['refused']}" if refused else ""
    return FaultOutcome(
        fault=fault.name,
        said=said,
        held_after_s=None if held is None else round(float(held["t"]) - start, 3),
        stopped_after_s=None if stopped is None else round(stopped, 3),
        driven_m=round(driven, 3),
        back_after_s=None if back is None else round(float(back["t"]) - end, 3),
        collisions=sum(event["event"] == "collision" for event in after),
    )
