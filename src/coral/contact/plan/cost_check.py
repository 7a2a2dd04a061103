"""Checks of a cost before the planner uses it; each fault is a sentence for the author of the cost.

A cost is judged by its values alone, so equal costs get equal verdicts however they are written, and no random number
is drawn, so one cost gets one verdict. Two mistakes make a planner fail although the cost runs: a term that begins
near the object and penalises coming near, which is refused, and a place inside something solid to which the cost
leads the hand, which the planner copes with and which is reported to the author.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.cost.context import Array, Context, Cost, Derived, Terms, Value
from coral.contact.cost.schema import objects_of
from coral.contact.cost_program.errors import CostError
from coral.contact.plan.attraction import Attraction, at_rest, follow_cost, total_cost
from coral.contact.plan.barrier_check import CostFault, gate_barriers, touch_barriers
from coral.contact.scene.geometry import rotation_of

STATES = 200
"""Number of sampled states in which a touch is tried."""
REACH_M = 0.015
"""Depth in a solid from which a place counts as out of reach; a fingertip is about as thick."""
TABLE = "table"


def verify_cost(cost: Cost, states: Context) -> list[CostFault]:
    """Return the faults of a cost; it may be used if none of them is fatal.

    The states are rolled out, varied enough to contain both good and bad rollouts; the first one is that in which the
    stage begins.
    """
    try:
        terms = cost(states)
    except CostError as error:
        return [CostFault(error.code, error.line, str(error))]
    faults = _malformed_faults(terms, states) or _constant_faults(terms, states)
    return faults or [*verify_approach(cost, states), *_idle_faults(terms)]


def verify_approach(cost: Cost, states: Context) -> list[CostFault]:
    """Return the faults of the way on which a cost leads the hand; see `verify_cost`."""
    values = at_rest(states)
    try:
        attraction = follow_cost(cost, values)
        return [
            *gate_barriers(cost, values, attraction),
            *touch_barriers(cost, pooled(states, STATES), attraction),
            *unreachable(values, attraction),
        ]
    except CostError as error:
        if error.code == "not_finite":  # at a place where no sampled motion has been
            return []
        return [CostFault(error.code, error.line, str(error))]


def pooled(states: Context, count: int) -> Context:
    """Choose states evenly from a batch, Shape=(n, 1)."""
    k, h = states.shape
    chosen = np.unique(np.linspace(0, k * h - 1, count).astype(int))
    values: dict[str, Value] = {}
    for name in states.names():
        values[name] = source = states.source(name)
        if not isinstance(source, Derived):
            full = np.broadcast_to(np.asarray(source, dtype=np.float64), (k, h, *source.shape[2:]))
            values[name] = full.reshape(k * h, 1, *source.shape[2:])[chosen]
    return Context(values, (len(chosen), 1))


def _malformed_faults(terms: Terms, states: Context) -> list[CostFault]:
    if not terms:
        return [CostFault("shape", 0, "the cost has no terms: return a number, or a dict of named terms")]
    for name, term in terms.items():
        values = np.asarray(term)
        fits = values.ndim == 2 and all(n in (1, m) for n, m in zip(values.shape, states.shape, strict=True))
        if not fits or not np.issubdtype(values.dtype, np.number):
            found = f"has shape {values.shape} in a batch of {states.shape}; it must be one number per state"
            return [CostFault("shape", 0, f"the term {name!r} {found}")]
        if not np.isfinite(values).all():
            found = "is nan or infinite in some state: guard its division, root or logarithm"
            return [CostFault("not_finite", 0, f"the term {name!r} {found}")]
    return []


def _constant_faults(terms: Terms, states: Context) -> list[CostFault]:
    rollouts = total_cost(terms, states.shape).sum(axis=1)
    if np.ptp(rollouts) > 1e-9 * (1.0 + np.abs(rollouts).max()):
        return []
    reason = (
        "the cost is the same for every sampled rollout, so it cannot tell good from bad; let "
        "it depend on where the hand and the objects are"
    )
    return [CostFault("constant", 0, reason)]


def _idle_faults(terms: Terms) -> list[CostFault]:
    """Find terms that never change: no reason to refuse, since a phase may not have begun, but worth reporting."""
    faults = []
    for name, values in terms.items():
        low, high = float(values.min()), float(values.max())
        if high - low <= 1e-12 * (1.0 + abs(high)):
            text = f"the term {name!r} is {high + 0.0:g} in every sampled state, so it guides nothing yet"
            faults.append(CostFault("constant", 0, text, fatal=False))
    return faults


def unreachable(values: Mapping[str, Any], attraction: Attraction) -> list[CostFault]:
    """Return a note for each body inside which the cost leads the hand (the first pitfall).

    The planner copes with such a cost: the hand presses against the surface. A condition that waits for the hand to
    arrive never holds, though, so the author learns how deep the place lies, and in what.
    """
    found: dict[str, list[float]] = {}
    for body, depth in (containing_body(values, end) for end in attraction.ends):
        if body:
            found.setdefault(body, []).append(depth)
    notes = []
    for body, depths in found.items():
        if 2 * len(depths) <= len(attraction.ends):
            continue
        reason = (
            f"the cost leads the hand to a place {np.median(depths):.3f} m inside the {body}, "
            f"which it cannot enter: it will press against the surface and stop there; aim at the surface, and "
            f"let no condition wait for the hand to come nearer than {np.median(depths) + REACH_M:.2f} m"
        )
        notes.append(CostFault("unreachable", 0, reason, fatal=False))
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
