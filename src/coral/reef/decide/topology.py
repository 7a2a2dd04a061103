"""The tour of all that is left, and what a choice costs: the topological memory (beyond the paper; its case V-D).

The verifiers of Eqs. 4-8 judge one waypoint against what is near. In branching reefs that lets the advisor take a
branch that ends in known water while another is left behind. Here the places that are left and the known ways between
them form a graph, and the tour past all of them tells which mode to ask in, and how much later what is left is seen
when another place comes first. That price is told, not refused: an advisor may know more than the map.
The trend of the chain, which the paper's memory gives to Eqs. 7 and 8, is `reference` in `verify.py`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.reef.decide.remaining import Place, Remaining
from coral.reef.decide.route import Arrival
from coral.reef.decide.survey import Survey
from coral.reef.map.costfield import CostField
from coral.reef.vehicle.delays import delays_from
from coral.reef.world.geometry import Pose, bearing

TOLD_S = 5.0
"""The price of a choice is reported from here on: less than an answer takes."""
SPEED_M_S, YAW_RATE_RAD_S = 0.5, 0.6
"""At which the robot drives and turns."""


@dataclass(frozen=True)
class RemainingTour:
    """The places that are left, and what has to follow each first choice."""

    places: tuple[Place, ...]
    fields: tuple[CostField, ...]
    """Distances (m) from each place."""
    onward_s: NDArray[np.float64]
    """Mean delay (s) of the other places once each place is reached, by worth. Shape=(N,)."""
    best_s: float
    """Mean delay (s) of all places with the best first choice."""
    start: Survey
    """Distances from where the tour begins."""
    pose: Pose

    @property
    def best(self) -> Place:
        """The place that should come first."""
        return min(self.places, key=lambda place: place.later_s)

    def price_s(self, x: float, y: float, index: int | None = None) -> float:
        """Return how much later (s) what is left is seen when a cluster, or a point, comes first; inf without a way."""
        known = next((place.later_s for place in self.places if index is not None and place.index == index), None)
        return float(self.prices_s(np.array([x]), np.array([y]))[0]) if known is None else known

    def prices_s(self, xs: NDArray[np.float64], ys: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the price (s) of going to points first, and to the places from there. Shape=(N,)."""
        first = self.start.field.lengths(xs, ys) / SPEED_M_S
        x, y, theta = self.pose
        off = np.arctan2(ys - y, xs - x) - theta
        first = first + np.abs(np.arctan2(np.sin(off), np.cos(off))) / YAW_RATE_RAD_S
        onward = np.min(
            [
                field.lengths(xs, ys) / SPEED_M_S + delay
                for field, delay in zip(self.fields, self.onward_s, strict=True)
            ],
            axis=0,
        )
        return np.asarray(np.maximum(first + onward - self.best_s, 0.0))


def plan_tour(remaining: Remaining, left: Survey, arrival: Arrival) -> RemainingTour | None:
    """Plan the tour of what is left from where the robot will be; None if nothing is left."""
    if not remaining.places:
        return None
    nodes = remaining.places
    first = np.array([left.field.lookup(n.x, n.y) for n in nodes]) / SPEED_M_S
    turns = np.array([abs(bearing(arrival.pose, n.x, n.y)) for n in nodes]) / YAW_RATE_RAD_S
    worth: NDArray[np.float64] = np.array([n.worth for n in nodes])
    onward = delays_from(remaining.between_m() / SPEED_M_S, worth)
    total: NDArray[np.float64] = first + turns + onward
    best = float(total.min())
    places = tuple(replace(n, later_s=float(t - best)) for n, t in zip(nodes, total, strict=True))
    return RemainingTour(places, remaining.fields, onward, best, left, arrival.pose)
