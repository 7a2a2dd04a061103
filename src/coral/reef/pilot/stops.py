"""Building blocks of tour planning: set cover by viewpoints, a short order of stops, moves of a local search."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SHIFT_M = 0.5
"""Distance by which the local search moves a stop."""
Place = tuple[float, float]
Stop = tuple[float, float, float]
"""A place (m) and the heading to turn to there (rad); nan: no turn."""

Route = list[Stop]


@dataclass(frozen=True)
class Sightings:
    """Which of M points each of V viewpoints sees: a sparse table, since a viewpoint sees few of the points."""

    points: NDArray[np.int32]
    """Indices of the points that are seen, viewpoint after viewpoint. Shape=(N,)."""
    ends: NDArray[np.int64]
    """Viewpoint v sees points[ends[v - 1] : ends[v]]. Shape=(V,)."""
    width: int
    """M."""

    @classmethod
    def of(cls, rows: Sequence[NDArray[np.intp]], width: int) -> Sightings:
        """Collect the indices of the points that each viewpoint sees, of `width` points."""
        ends = np.cumsum([len(points) for points in rows], dtype=np.int64)
        return cls(np.concatenate([np.empty(0), *rows]).astype(np.int32), ends, width)

    @classmethod
    def together(cls, parts: Sequence[Sightings]) -> Sightings:
        """Join tables over the same points, one after another."""
        before = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
        ends = np.concatenate([part.ends + n for part, n in zip(parts, before, strict=True)])
        return cls(np.concatenate([part.points for part in parts]), ends, parts[0].width)

    def row(self, v: int) -> NDArray[np.int32]:
        """Return the points that viewpoint v sees."""
        return self.points[self.ends[v - 1] if v else 0 : self.ends[v]]

    def seen(self) -> NDArray[np.bool_]:
        """Return whether any viewpoint sees each point. Shape=(M,)."""
        mask = np.zeros(self.width, np.bool_)
        mask[self.points] = True
        return mask

    def worth(self, weight: NDArray[np.float64]) -> NDArray[np.float64]:
        """Add up the weights, Shape=(M,), of the points that each viewpoint sees. Shape=(V,)."""
        begins = np.concatenate([[0], self.ends[:-1]])[: len(self.ends)]
        sums = np.add.reduceat(np.append(weight[self.points], 0.0), begins)
        return np.where(begins < self.ends, sums, 0.0)


def greedy_cover(sightings: Sightings, weight: NDArray[np.float64]) -> list[int]:
    """Choose few viewpoints that together see what all see, each time the one that adds most weight, Shape=(M,)."""
    left, chosen = sightings.seen(), list[int]()
    while left.any():
        best = int(np.argmax(sightings.worth(np.where(left, weight, 0.0))))
        if not left[sightings.row(best)].any():
            best = int(np.argmax(sightings.worth(left.astype(np.float64))))
        chosen.append(best)
        left[sightings.row(best)] = False
    return chosen


def order_stops(distance: NDArray[np.float64]) -> list[int]:
    """Find a short open tour: nearest neighbour, then 2-opt and Or-opt until neither shortens it.

    Args:
        distance: Shape=(N + 1, N), distance (m) from the start (row 0) and from stop k (row k + 1) to every stop.
    """
    left, order, at = set(range(distance.shape[1])), list[int](), 0
    while left:
        best = min(left, key=lambda k: (distance[at, k], k))
        left.remove(best)
        order.append(best)
        at = best + 1

    def length(route: Sequence[int]) -> float:
        return float(sum(distance[a, b] for a, b in zip([0, *(k + 1 for k in route)], route, strict=False)))

    better, best_length = True, length(order)
    while better:
        better = False
        for changed in neighbours(order):
            if (found := length(changed)) < best_length - 1e-9:
                order, best_length, better = changed, found, True
                break
    return order


def neighbours(route: Sequence[int]) -> Iterator[list[int]]:
    """Yield every route with one stretch reversed (2-opt) or up to three consecutive stops moved elsewhere (Or-opt)."""
    n = len(route)
    for i, j in itertools.combinations(range(n + 1), 2):
        if j - i >= 2:
            yield [*route[:i], *reversed(route[i:j]), *route[j:]]
    for size, i in itertools.product((1, 2, 3), range(n)):
        rest, part = [*route[:i], *route[i + size :]], route[i : i + size]
        if i + size <= n:
            yield from ([*rest[:k], *part, *rest[k:]] for k in range(len(rest) + 1) if k != i)


def without(route: Route) -> Iterator[Route]:
    """Yield every route with one stop removed."""
    for k in range(len(route)):
        yield [*route[:k], *route[k + 1 :]]


def unturned(route: Route) -> Iterator[Route]:
    """Yield every route in which one stop loses its heading."""
    for k, (x, y, theta) in enumerate(route):
        if math.isfinite(theta):
            yield [*route[:k], (x, y, math.nan), *route[k + 1 :]]


def rearranged(route: Route) -> Iterator[Route]:
    """Yield every neighbour of a route in the sense of 2-opt and Or-opt."""
    for order in neighbours(range(len(route))):
        yield [route[k] for k in order]


def shifted(route: Route) -> Iterator[Route]:
    """Yield every route with one stop moved by `SHIFT_M` in one of eight directions."""
    for k, (x, y, theta) in enumerate(route):
        for angle in np.arange(8) * (math.pi / 4):
            aside = round(x + SHIFT_M * math.cos(angle), 3), round(y + SHIFT_M * math.sin(angle), 3)
            yield [*route[:k], (*aside, theta), *route[k + 1 :]]
