"""What is left to go to, and the known ways to it: clusters not yet seen from near, and frontiers."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from coral.reef.decide.outlook import Outlook
from coral.reef.decide.survey import Frontier, Survey
from coral.reef.map.costfield import CostField, CostFieldCfg

MOST_PLACES = 9
"""Places with known ways; the nearest ones, clusters first. The search for a tour grows as n² 2^n."""
GAP_M = 4.0
"""Frontiers closer than this to one that is among them add none."""
RATIO = 3
"""Map cells per cell of the distance search."""


@dataclass(frozen=True, kw_only=True)
class Dot:
    """A cluster that is left."""

    x: float
    y: float
    index: int
    left_m2: float
    """What is left to see of it."""


@dataclass(frozen=True)
class Remaining:
    """The places that are left."""

    places: tuple[Dot | Frontier, ...]
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


def what_remains(outlook: Outlook, left: Survey, dots: Sequence[Dot], fields: CostFieldCfg) -> Remaining:
    """Collect the places that are left."""
    belief = outlook.belief
    near = sorted(dots, key=lambda dot: (left.path_m(dot.x, dot.y), dot.x, dot.y))
    within_reach = (dot for dot in near if math.isfinite(left.path_m(dot.x, dot.y)))
    places: list[Dot | Frontier] = list(itertools.islice(within_reach, MOST_PLACES))
    for front in left.frontiers:
        apart = all(math.dist((front.x, front.y), (p.x, p.y)) >= GAP_M for p in places if isinstance(p, Frontier))
        if len(places) < MOST_PLACES and apart:
            places.append(front)
    chosen = {id(place) for place in places}
    known: list[Dot | Frontier] = [*dots, *left.frontiers]
    beyond = [(p.x, p.y) for p in known if id(p) not in chosen]
    coarse = replace(fields, ratio=RATIO)
    water = belief.water(coarse)
    ways = tuple(CostField.over(water.slowness, (p.x, p.y), cell_m=water.cell_m, cfg=coarse) for p in places)
    return Remaining(tuple(places), ways, np.array(beyond, np.float64).reshape(-1, 2))
