"""The lines along which a reef grows: the paper's five topologies (IV-A) and even places on them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from coral.reef.generator.wild_spines import WILD

Line = NDArray[np.float64]
Topology = Literal["L", "S", "K", "E", "O", "branching", "looping", "patchy"]
"""The paper's five, which only their size changes, and three that are drawn at random (`wild_spines`)."""

_STEP_M = 0.1
_LOOP_M = 1.5
"""A line that ends within this distance of an earlier part of itself is a closed loop."""


def _circle() -> list[tuple[float, float]]:
    angles = np.linspace(-0.5 * math.pi, 1.5 * math.pi, 49)
    return [(0.52 + 0.23 * math.cos(a), 0.51 + 0.23 * math.sin(a)) for a in angles]


_SPINES: dict[Topology, list[list[tuple[float, float]]]] = {
    "L": [[(0.12, 0.22), (0.76, 0.22), (0.76, 0.86)]],
    "S": [
        [
            (0.20, 0.24),
            (0.63, 0.21),
            (0.77, 0.30),
            (0.72, 0.45),
            (0.50, 0.50),
            (0.28, 0.55),
            (0.23, 0.70),
            (0.37, 0.79),
            (0.72, 0.77),
        ]
    ],
    "K": [[(0.22, 0.14), (0.22, 0.79)], [(0.22, 0.46), (0.60, 0.74)], [(0.22, 0.46), (0.64, 0.26)]],
    "E": [
        [(0.26, 0.11), (0.26, 0.76)],
        [(0.26, 0.24), (0.60, 0.24)],
        [(0.26, 0.50), (0.60, 0.50)],
        [(0.26, 0.76), (0.60, 0.76)],
    ],
    "O": [[(0.33, 0.13), *_circle()]],
}
"""Polylines in units of the world's size, start first. At 20 m the prongs of the E are 5.2 m apart. The arms of the K
branch off at 54° and 115°."""

_ROUNDED: dict[str, int] = {"L": 1, "S": 3}
"""Rounds of corner cutting."""


def topology_lines(
    topology: Topology, size_m: tuple[float, float], rng: np.random.Generator | None = None
) -> list[Line]:
    """Return polylines of a topology, Shape=(K, 2), metres: the line from the start, then those that branch off it."""
    if topology in WILD:
        return WILD[topology](size_m, rng or np.random.default_rng(0))
    scale = np.array(size_m)
    return [_cut_corners(np.array(line), _ROUNDED.get(topology, 0)) * scale for line in _SPINES[topology]]


TOPOLOGIES = tuple(_SPINES)
"""The paper's."""
EVERY_TOPOLOGY: tuple[Topology, ...] = (*TOPOLOGIES, "branching", "looping", "patchy")


def spread(lines: Sequence[Line], count: int, lead_m: float) -> list[tuple[float, float, float]]:
    """Place points on the lines, evenly as their number allows, one on every line at least: x, y, direction there.

    The first `lead_m` from the start stay empty. Lines are polylines, Shape=(K, 2); the others branch off the first.
    """
    arcs = [_arc(line) for line in lines]
    begin, first = lead_m, float(arcs[0][2][-1])
    loop = _loop_begin(arcs[0])
    closed = loop is not None
    if loop is not None:
        begin = max(loop, lead_m)
    counts = [min(1 + (not closed), count - len(lines) + 1), *[1] * (len(lines) - 1)]

    def spacing(k: int) -> float:
        if k:
            return float(arcs[k][2][-1]) / counts[k]
        return (first - begin) / (counts[0] if closed else counts[0] - 1 or 1)

    while sum(counts) < count:
        counts[max(range(len(lines)), key=spacing)] += 1
    places = []
    for k, (points, yaws, along) in enumerate(arcs):
        gap = spacing(k)
        for j in range(counts[k]):
            i = int(np.argmin(np.abs(along - (begin + j * gap if k == 0 else (j + 1) * gap))))
            places.append((float(points[i, 0]), float(points[i, 1]), float(yaws[i])))
    return places


def samples(lines: Sequence[Line]) -> Line:
    """Sample the lines every 0.1 m. Shape=(N, 2)."""
    return np.concatenate([_arc(line)[0] for line in lines])


def _arc(line: Line) -> tuple[Line, NDArray[np.float64], NDArray[np.float64]]:
    """Sample a line: points, Shape=(N, 2), direction of the line and arc length there, Shape=(N,) each."""
    edges = np.diff(line, axis=0)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(edges[:, 0], edges[:, 1]))])
    at = np.linspace(0.0, along[-1], max(2, round(along[-1] / _STEP_M) + 1))
    points = np.stack([np.interp(at, along, line[:, axis]) for axis in (0, 1)], axis=1)
    edge = np.clip(np.searchsorted(along, at, side="right") - 1, 0, len(edges) - 1)
    return points, np.arctan2(edges[edge, 1], edges[edge, 0]), at


def _loop_begin(arc: tuple[Line, NDArray[np.float64], NDArray[np.float64]]) -> float | None:
    """Return the arc length (m) at which the loop of a line begins that its end closes; None without a loop."""
    points, _, along = arc
    away = np.hypot(*(points - points[-1]).T)
    away[along > along[-1] - 3 * _LOOP_M] = np.inf
    return float(along[np.argmin(away)]) if away.min() < _LOOP_M else None


def _cut_corners(line: Line, rounds: int) -> Line:
    """Cut corners by Chaikin's rule. The ends stay."""
    for _ in range(rounds):
        quarter, three = 0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]
        line = np.concatenate([line[:1], np.stack([quarter, three], axis=1).reshape(-1, 2)[1:-1], line[-1:]])
    return line
