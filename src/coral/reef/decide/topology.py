"""The tour of all that is left, and what a choice costs: the topological memory (beyond the paper; its case V-D).

The verifiers of Eqs. 4-8 judge one waypoint against what is near. In branching reefs that lets the advisor take a
branch that ends in known water while another is left behind. Here the places that are left and the known ways between
them form a graph, and the tour past all of them tells which mode to ask in, and how much later what is left is seen
when another place comes first. That price is told, not refused: an advisor may know more than the map.
The trend of the chain, which the paper's memory gives to Eqs. 7 and 8, is `reference` in `verify.py`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.reef.decide.outlook import Outlook
from coral.reef.decide.route import Arrival
from coral.reef.decide.survey import Survey
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.vehicle.delays import delays_from
from coral.reef.world.geometry import Pose, bearing

MOST_PLACES = 9
"""Places with known ways; the nearest ones, clusters first. The search for a tour grows as n² 2^n."""
GAP_M = 4.0
"""Frontiers closer than this to one that is among them add none."""
RATIO = 3
"""Map cells per cell of the distance search."""
DOT_WORTH = 0.5
"""Worth of a cluster, whatever its size; each square metre that is left to see of it adds 1."""
FAR_M2 = 0.5
"""What is taken to be left to see of oysters seen from afar: about a small cluster's area."""
FRONTIER_WORTH, REEF_M = 0.1, 3.0
"""Worth of unexplored water beside the reef, and distance from it at which that has fallen to 1/e. Little: most of it
is seen on the way to clusters."""
TOLD_S = 5.0
"""The price of a choice is reported from here on: less than an answer takes."""
SPEED_M_S, YAW_RATE_RAD_S = 0.5, 0.6
"""At which the robot drives and turns."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """A place that is left: a cluster (with its label) or a frontier."""

    x: float
    y: float
    index: int | None
    worth: float
    later_s: float = 0.0
    """How much later (s) what is left is seen, on average by worth, when this place comes first."""


@dataclass(frozen=True)
class Remaining:
    """The places that are left."""

    places: tuple[Place, ...]
    """Those with known ways, clusters first."""
    fields: tuple[CostField, ...]
    """Distances (m) from each of them."""
    beyond: NDArray[np.float64]
    """The others. Shape=(M, 2), metres."""

    def between_m(self) -> NDArray[np.float64]:
        """Return the lengths of the ways between the places (m). Shape=(N, N)."""
        return np.array(
            [
                [0.0 if k == j else way.lookup(b.x, b.y) for j, b in enumerate(self.places)]
                for k, way in enumerate(self.fields)
            ]
        )

    def nearer(
        self, xs: NDArray[np.float64], ys: NDArray[np.float64], start: tuple[float, float], tolerance_m: float
    ) -> NDArray[np.bool_]:
        """Tell which points are nearer to something that is left than `start` is, or hardly farther. Shape=(N,).

        To places without a known way the straight distance counts, in the points' favour.
        """
        found = np.zeros(len(xs), bool)
        for field in self.fields:
            found |= field.lengths(xs, ys) < field.lookup(*start) + tolerance_m
        for x, y in self.beyond:
            found |= np.hypot(xs - x, ys - y) < math.dist(start, (x, y)) + tolerance_m
        return found


def what_remains(outlook: Outlook, left: Survey, dots: Sequence[Place], fields: CostFieldCfg) -> Remaining:
    """Collect the places that are left."""
    near = sorted(dots, key=lambda dot: (left.path_m(dot.x, dot.y), dot.x, dot.y))
    within_reach = (dot for dot in near if math.isfinite(left.path_m(dot.x, dot.y)))
    places = list(itertools.islice(within_reach, MOST_PLACES))
    water = [Place(x=f.x, y=f.y, index=None, worth=frontier_worth(f.reef_m, f.unexplored)) for f in left.frontiers]
    for front in water:
        apart = all(math.dist((front.x, front.y), (p.x, p.y)) >= GAP_M for p in places if p.index is None)
        if len(places) < MOST_PLACES and apart:
            places.append(front)
    chosen = {id(place) for place in places}
    beyond = [(p.x, p.y) for p in (*dots, *water) if id(p) not in chosen]
    coarse = replace(fields, ratio=RATIO)
    sea = outlook.belief.water(coarse)
    ways = tuple(CostField.over(sea.slowness, (p.x, p.y), cell_m=sea.cell_m, cfg=coarse) for p in places)
    return Remaining(tuple(places), ways, np.array(beyond, np.float64).reshape(-1, 2))


def frontier_worth(reef_m: float, unexplored: float) -> float:
    """Return what a frontier promises: oysters settle near others (inf m: none known), and fill unexplored water."""
    near = math.exp(-reef_m / REEF_M) if math.isfinite(reef_m) else 0.5
    return FRONTIER_WORTH * (0.2 + near) * min(1.0, 2.0 * unexplored)


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
        if known is not None:
            return known
        at = np.array([x]), np.array([y])
        first = float(self.start.field.lengths(*at)[0]) / SPEED_M_S
        first += abs(bearing(self.pose, x, y)) / YAW_RATE_RAD_S
        onward = min(
            float(field.lengths(*at)[0]) / SPEED_M_S + float(delay)
            for field, delay in zip(self.fields, self.onward_s, strict=True)
        )
        return max(first + onward - self.best_s, 0.0)


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
