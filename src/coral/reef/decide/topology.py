"""The tour of all that is left, and what a choice costs: the topological memory (beyond the paper; its case V-D).

The verifiers of Eqs. 4-8 judge one waypoint against what is near. In branching reefs that lets the advisor take a
branch that ends in known water while another is left behind. Here the places that are left (clusters not yet seen
from near, some of them known from afar only, and frontiers) and the known ways between them form a graph, and a
choice is judged by the tour that has to follow it. Its regret is how much later, on average, what is left is seen
than after the best first choice.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Positive
from coral.reef.decide.route import Arrival, turn_to
from coral.reef.decide.survey import Survey
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostField, CostFieldCfg
from coral.reef.vehicle.delays import delays_from
from coral.reef.world.geometry import Pose


@dataclass(frozen=True, kw_only=True)
class TopologyCfg:
    """Size of the graph, what its places are worth, and what counts as leading back."""

    enabled: bool = True
    """False is the ablation "w/o topological memory"."""
    max_nodes: int = 9
    """Places that a tour is planned over; the nearest ones, clusters first. The search grows as n² 2^n."""
    frontier_gap_m: float = 4.0
    """Frontiers closer than this to a place already in the graph add none."""
    max_regret_s: float = 10.0
    """A choice that delays what is left by more than this is refused: what asking once more costs."""
    ratio: Count = 3
    """Map cells per cell of the distance search."""
    speed_m_s: Positive = 0.5
    yaw_rate_rad_s: Positive = 0.6
    dot_worth: float = 0.5
    """Worth of a cluster, whatever its size; each square metre that is left to see of it adds 1."""
    far_m2: float = 0.5
    """What is taken to be left to see of oysters seen from afar: about a small cluster's area."""
    frontier_worth: float = 0.1
    """Worth of unexplored water beside the reef, less elsewhere. Little: most of it is seen on the way to clusters."""
    reef_m: Positive = 3.0
    """Distance from the reef at which that has fallen to 1/e."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """A place that is left: a cluster (with its label) or a frontier."""

    x: float
    y: float
    index: int | None = None
    worth: float = 1.0
    regret_s: float = 0.0
    """How much later (s) what is left is seen, on average by worth, when this place comes first."""


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
    cfg: TopologyCfg
    between_s: NDArray[np.float64]
    """Travelling times between the places (s). Shape=(N, N)."""

    @property
    def best(self) -> Place:
        """The place that should come first."""
        return min(self.places, key=lambda place: place.regret_s)

    def regret_of(self, index: int) -> float | None:
        """Return the regret (s) of going to a cluster first; None if the tour does not know it."""
        return next((place.regret_s for place in self.places if place.index == index), None)

    def regret_after(self, before: Sequence[int], index: int) -> float | None:
        """Return the regret (s) of going to a cluster next, when others have been seen by then.

        Args:
            before: Labels of the clusters seen by then, in order; the robot is at the last one.
            index: Label of the next cluster.

        Returns:
            How much later (s) what is then left is seen, on average by worth, than with the best next place. None if
            the tour does not know the cluster or the last one before it.
        """
        known = {place.index: k for k, place in enumerate(self.places) if place.index is not None}
        if index not in known or not before or before[-1] not in known:
            return None
        left = [k for k, place in enumerate(self.places) if place.index is None or place.index not in before]
        if known[index] not in left:
            return None
        worth: NDArray[np.float64] = np.array([self.places[k].worth for k in left])
        delay = self.between_s[known[before[-1]], left] + delays_from(self.between_s[np.ix_(left, left)], worth)
        return float(delay[left.index(known[index])] - delay.min())

    def worthwhile(self, first: int | None, then: Sequence[int]) -> list[int]:
        """Return the labels that follow a first one, without repetitions, up to the first that loses too much time."""
        before, kept = [] if first is None else [first], []
        for index in then:
            if index in before:
                continue
            regret = self.regret_after(before, index)
            if regret is not None and regret > self.cfg.max_regret_s:
                break
            before.append(index)
            kept.append(index)
        return kept

    def regrets_at(self, xs: NDArray[np.float64], ys: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the regret (s) of going to points first, and to the places from there. Shape=(N,)."""
        cfg = self.cfg
        first = self.start.paths_m(xs, ys) / cfg.speed_m_s
        x, y, theta = self.pose
        bearing = np.arctan2(ys - y, xs - x) - theta
        first = first + np.abs(np.arctan2(np.sin(bearing), np.cos(bearing))) / cfg.yaw_rate_rad_s
        onward = np.min(
            [
                field.lengths(xs, ys) / cfg.speed_m_s + delay
                for field, delay in zip(self.fields, self.onward_s, strict=True)
            ],
            axis=0,
        )
        return np.asarray(np.maximum(first + onward - self.best_s, 0.0))


def plan_tour(
    belief: Belief,
    left: Survey,
    arrival: Arrival,
    dots: Sequence[tuple[float, float, int, float]],
    fields: CostFieldCfg,
    cfg: TopologyCfg,
) -> RemainingTour | None:
    """Plan the tour of what is left from where the robot will be; None if nothing is left.

    Args:
        belief: What the robot knows.
        left: What is left to explore, with the distances from `arrival`.
        arrival: Where the tour begins.
        dots: Clusters on offer: x, y (m), label, what is left to see of it (m²).
        fields: How obstacles are inflated for the distances.
        cfg: Size and worth.
    """
    # The tour is this robot's own: what is nearer to another robot is that one's to visit.
    near = sorted((left.path_m(x, y), x, y, index, area) for x, y, index, area in dots)
    nodes = [
        Place(x=x, y=y, index=index, worth=cfg.dot_worth + area)
        for path, x, y, index, area in near
        if math.isfinite(path) and not belief.nearer_to_another(x, y)
    ][: cfg.max_nodes]
    others = [(f.x, f.y, frontier_worth(f.reef_m, f.unexplored, cfg)) for f in left.frontiers]
    for x, y, promise in others:
        if len(nodes) == cfg.max_nodes:
            break
        far = all(math.hypot(x - n.x, y - n.y) >= cfg.frontier_gap_m for n in nodes if n.index is None)
        if far and not belief.nearer_to_another(x, y):
            nodes.append(Place(x=x, y=y, worth=promise))
    if not nodes:
        return None
    coarse = replace(fields, ratio=cfg.ratio)
    water = belief.water(coarse)
    ways = tuple(CostField.over(water.slowness, (n.x, n.y), cell_m=water.cell_m, cfg=coarse) for n in nodes)
    between = np.array(
        [[0.0 if k == j else way.lookup(b.x, b.y) for j, b in enumerate(nodes)] for k, way in enumerate(ways)]
    )
    first = np.array([left.field.lookup(n.x, n.y) for n in nodes]) / cfg.speed_m_s
    turns = np.array([turn_to(arrival.pose, n.x, n.y) for n in nodes]) / cfg.yaw_rate_rad_s
    worth: NDArray[np.float64] = np.array([n.worth for n in nodes])
    between_s = between / cfg.speed_m_s
    onward = delays_from(between_s, worth)
    total: NDArray[np.float64] = first + turns + onward
    best = float(total.min())
    places = tuple(replace(n, regret_s=float(t - best)) for n, t in zip(nodes, total, strict=True))
    return RemainingTour(places, ways, onward, best, left, arrival.pose, cfg, between_s)


def frontier_worth(reef_m: float, unexplored: float, cfg: TopologyCfg) -> float:
    """Return what a frontier promises: oysters settle near oysters, and more of them fit into more water.

    Args:
        reef_m: Distance to the nearest known oysters (m); inf when none are known.
        unexplored: Unexplored share of its surroundings.
        cfg: Worths.
    """
    near = math.exp(-reef_m / cfg.reef_m) if math.isfinite(reef_m) else 0.5
    return cfg.frontier_worth * (0.2 + near) * min(1.0, 2.0 * unexplored)
