"""Where a cost leads the hand, found from its values alone: equal costs lead to one place, however they are written."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from coral.contact.cost.context import Array, Context, Cost, Terms
from coral.contact.cost.schema import objects_of

DIRECTIONS: Array = np.array([step for step in product((-1.0, 0.0, 1.0), repeat=3) if any(step)])
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)
"""Directions in which the hand is moved, Shape=(26, 3)."""
STRIDES: tuple[tuple[float, int], ...] = ((0.04, 16), (0.012, 8), (0.004, 8), (0.0015, 6))
"""Length (m) and maximum number of steps of each round of the descent."""
AROUND_M = 0.16
"""Distance from an object at which descents begin."""
MOST_STARTS = 13


@dataclass(frozen=True, eq=False)
class Attraction:
    """Descents of a cost over the position of the hand; everything else stays as it is."""

    ends: Array
    """Positions from which no step in any direction lowers the cost, Shape=(n, 3) m."""
    reached: Array
    """Cost at the end, Shape=(n,)."""
    span: float
    """Typical fall of the cost on the way."""


def total_cost(terms: Terms, shape: tuple[int, int]) -> Array:
    """Sum the terms of every state, Shape=shape."""
    total = np.zeros(shape)
    for term in terms.values():
        total = total + np.asarray(term)
    return np.broadcast_to(total, shape)


def at_rest(state: Context) -> dict[str, Any]:
    """Return the quantities of one state, a batch of one, with nothing moving and nothing touched by the hand.

    Derived ones stay so: clearances follow the hand to other positions.
    """
    first = state.first()
    values: dict[str, Any] = {name: first.source(name) for name in first.names()}
    for name in values:
        if name in ("ee_force", "ee_torque", "last_action") or name.endswith(
            ("_vel", "_angvel", "_hand_force", *(f"_{part}_contact" for part in ("hand", "palm", "left", "right")))
        ):
            values[name] = np.zeros_like(values[name])
    return values


def cost_at(cost: Cost, values: dict[str, Any], positions: Array) -> Array:
    """Compute the cost of one state, Shape=(n,), with the hand at other positions, Shape=(n, 3) m."""
    shape = (len(positions), 1)
    return total_cost(cost(Context({**values, "ee_pos": positions[:, None, :]}, shape)), shape)[:, 0]


def follow_cost(cost: Cost, values: dict[str, Any]) -> Attraction:
    """Move the hand downhill from where it is and from around each object, in a state as `at_rest` returns it.

    Raises:
        CostError: The cost cannot be evaluated.
    """
    ends, begun, reached = descend(cost, values, starting_places(values))
    return Attraction(ends, reached, float(np.median(begun - reached)))


def descend(
    cost: Cost, values: dict[str, Any], starts: Array, strides: tuple[tuple[float, int], ...] = STRIDES
) -> tuple[Array, Array, Array]:
    """Move the hand of one state downhill from several places, Shape=(n, 3) m.

    Returns the last positions, Shape=(n, 3) m, and the cost at the first and at the last ones, Shape=(n,).
    """
    hand = starts.copy()
    begun = reached = cost_at(cost, values, hand)
    for stride, most in strides:
        for _ in range(most):
            tried = hand[:, None, :] + stride * DIRECTIONS
            found = cost_at(cost, values, tried.reshape(-1, 3)).reshape(len(hand), -1)
            best = found.argmin(axis=1)
            rows = np.arange(len(hand))
            better = found[rows, best] < reached - 1e-12 * (1.0 + np.abs(reached))
            if not better.any():
                break
            hand = np.where(better[:, None], tried[rows, best], hand)
            reached = np.where(better, found[rows, best], reached)
    return hand, begun, reached


def starting_places(values: dict[str, Any]) -> Array:
    """Return where descents begin: the hand's position, and places beside and above each object, Shape=(n, 3) m."""
    places = [values["ee_pos"][0, 0]]
    for name in objects_of(values):
        centre = values[f"{name}_pos"][0, 0]
        half = np.linalg.norm(values[f"{name}_size"][0, 0]) / 2 if f"{name}_size" in values else 0.05
        for way in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.4), (-1.0, 0.0, 0.4), (0.0, 1.0, 0.4), (0.0, -1.0, 0.4)):
            unit = np.asarray(way) / np.linalg.norm(way)
            places.append(centre + (half + AROUND_M) * unit)
    return np.array(places[:MOST_STARTS])
