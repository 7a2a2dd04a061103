"""Check whether the place to which a cost leads the hand lies inside something solid.

The planner copes with such a cost: the hand presses against the surface. A condition that waits for the hand to arrive
never holds, though, so the author learns how deep the place lies, and in what.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.cost.context import Array, Context, Cost
from coral.contact.cost_program.state import objects_of
from coral.contact.plan.attraction import Attraction
from coral.contact.plan.cost_fault import CostFault, Traceable, quoted
from coral.contact.scene.geometry import rotation_of

REACH_M = 0.015
"""Depth in a solid from which a place counts as out of reach; a fingertip is about as thick."""
TABLE = "table"


def unreachable(cost: Cost, values: Mapping[str, Any], attraction: Attraction) -> list[CostFault]:
    """Return a note for each body inside which the cost leads the hand (the first pitfall)."""
    found: dict[str, list[float]] = {}
    inside = [containing_body(values, end) for end in attraction.ends]
    for body, depth in inside:
        if body:
            found.setdefault(body, []).append(depth)
    notes = []
    for body, depths in found.items():
        if 2 * len(depths) <= len(attraction.ends):
            continue
        line = _line_of_target(cost, values, attraction, np.array([name == body for name, _ in inside]))
        reason = (
            f"{quoted(cost, line)}the cost leads the hand to a place {np.median(depths):.3f} m inside the {body}, "
            f"which it cannot enter: it will press against the surface and stop there; aim at the surface, and "
            f"let no condition wait for the hand to come nearer than {np.median(depths) + REACH_M:.2f} m"
        )
        notes.append(CostFault("unreachable", line, reason, fatal=False))
    return notes


def containing_body(values: Mapping[str, Any], point: Array) -> tuple[str, float]:
    """Return the body that keeps the fingertips from a point, and how deep the point lies in it; "" if none does.

    An object that the open fingers can straddle is no obstacle.
    """
    deepest, name = REACH_M, ""
    movable = objects_of(values)
    for thing in (item.removesuffix("_size") for item in values if item.endswith("_size")):
        size, centre = values[f"{thing}_size"][0, 0], values[f"{thing}_pos"][0, 0]
        if thing in movable and size.min() < MAX_OPENING_M:
            continue
        turn = rotation_of(values[f"{thing}_quat"][0, 0]) if f"{thing}_quat" in values else np.eye(3)
        depth = float((size / 2 - np.abs(turn.T @ (point - centre))).min())
        if depth > deepest:
            deepest, name = depth, thing
    if "table_min" in values and not name:
        low, high = values["table_min"][0, 0], values["table_max"][0, 0]
        depth = float(min((point - low)[:2].min(), (high - point).min()))
        if depth > deepest and point[2] > low[2]:
            deepest, name = depth, TABLE
    return name, deepest


def _line_of_target(cost: Cost, values: Mapping[str, Any], attraction: Attraction, which: Array) -> int:
    """Return the line of the distance that vanishes where the cost leads the hand; 0 if none does."""
    if not isinstance(cost, Traceable):
        return 0
    ends = attraction.ends[which]
    traced = cost.trace(Context({**values, "ee_pos": ends[:, None, :]}, (len(ends), 1)))
    near = [(float(np.median(item.value)), item.line) for item in traced.distances]
    return min(near)[1] if near and min(near)[0] < 0.01 else 0
