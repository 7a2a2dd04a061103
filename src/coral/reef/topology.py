"""Topological memory: which choice leads on, and which leads back (beyond the paper; its failure case, V-D).

The verifiers of Eqs. 4-8 judge one waypoint against what is near. In branching reefs that lets the advisor take a
branch which ends in known water while another is left behind. Here the places that are left (unvisited clusters and
the larger frontiers) and the known ways between them form a graph, and a choice is judged by the whole tour that has
to follow it: its regret is how much longer that tour is than the best one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.config import Count
from coral.reef.belief import Belief
from coral.reef.costfield import CostField, CostFieldCfg
from coral.reef.survey import Survey


@dataclass(frozen=True, kw_only=True)
class TopologyCfg:
    """Size of the graph and what counts as leading back."""

    enabled: bool = True
    """False is the ablation "w/o topological memory"."""
    max_nodes: int = 8
    """Places that a tour is planned over; the nearest ones, clusters first. The search grows as n² 2^n."""
    frontier_gap_m: float = 5.0
    """Frontiers closer than this to a place already in the graph add none."""
    max_regret_m: float = 8.0
    """A cluster whose choice lengthens the tour by more than this is refused when another does not."""
    ratio: Count = 3
    """Map cells per cell of the distance search."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """A remaining place: an unvisited cluster (with its label) or a frontier (None)."""

    x: float
    y: float
    index: int | None
    regret_m: float = 0.0
    """How much longer the tour of all places is when this one comes first (m)."""


def places_left(belief: Belief, left: Survey, fields: CostFieldCfg, cfg: TopologyCfg) -> tuple[Place, ...]:
    """Build the graph of remaining places, each with its regret; empty if the memory is off or nothing is left."""
    if not cfg.enabled:
        return ()
    # The tour is this robot's own: what is nearer to another robot is that one's to visit.
    share = [t for t in belief.unvisited() if not belief.nearer_to_another(t.x, t.y)]
    clusters = sorted((left.path_m(t.x, t.y), t.x, t.y, t.index) for t in share)
    nodes = [Place(x=x, y=y, index=index) for path, x, y, index in clusters if math.isfinite(path)][: cfg.max_nodes]
    for f in left.frontiers:
        if len(nodes) == cfg.max_nodes:
            break
        if belief.nearer_to_another(f.x, f.y):
            continue
        if all(math.hypot(f.x - n.x, f.y - n.y) >= cfg.frontier_gap_m for n in nodes):
            nodes.append(Place(x=f.x, y=f.y, index=None))
    if not nodes:
        return ()
    distance, cell_m = belief.map.distance(), belief.map.cfg.cell_m
    coarse = replace(fields, ratio=cfg.ratio)
    between = np.zeros((len(nodes), len(nodes)))
    for i, node in enumerate(nodes[:-1]):
        field = CostField.compute(distance, (node.x, node.y), cell_m=cell_m, cfg=coarse)
        for j in range(i + 1, len(nodes)):
            between[i, j] = between[j, i] = field.lookup(nodes[j].x, nodes[j].y)
    first = np.array([left.field.lookup(n.x, n.y) for n in nodes])
    tours = first + tours_from(between)
    return tuple(replace(n, regret_m=float(t - tours.min())) for n, t in zip(nodes, tours, strict=True))


def tours_from(between: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the shortest open tour of all places from each place, by dynamic programming over subsets.

    Args:
        between: Shape=(N, N), symmetric distances (m).

    Returns:
        Shape=(N,), metres.
    """
    n = len(between)
    full = (1 << n) - 1
    best = np.full((1 << n, n), np.inf)  # best[S, i]: shortest way from i through the places S still to visit
    best[0] = 0.0
    for subset in range(1, full + 1):
        members = [j for j in range(n) if subset >> j & 1]
        rest = np.array([best[subset ^ (1 << j), j] for j in members])
        best[subset] = np.min(between[:, members] + rest, axis=1)
    return np.array([best[full ^ (1 << i), i] for i in range(n)])
