"""Spines of large reefs, drawn at random: branching, looping, and broken into patches."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Line = NDArray[np.float64]

STEP_M = 1.0
"""Length of a piece of a drawn line."""
BORDER_M = 3.5
"""Kept free between a line and the world's edge."""
APART_M = 6.5
"""Between two lines, but where they meet: a robot on one of them sees the other now and then, not all the time."""
GAP_M, GAP = (8.0, 13.0), 0.21
"""Between a patch and the nearest one: farther than the 6 m that the robot's map reaches, where the world is large
enough; at least this share of its edge."""
TRIES = 300


def branching(size_m: tuple[float, float], rng: np.random.Generator) -> list[Line]:
    """Draw a trunk through the world, branches off it, and twigs off these. Polylines, Shape=(K, 2) each, metres."""
    edge = min(size_m)
    lines = [_first_line(0.2, 1.2 * size_m[0], size_m, rng)]  # winds from one side of the world to the other
    for length_m, wanted in ((0.4 * edge, 4), (0.2 * edge, 2)):
        parents = list(lines)
        for _ in range(TRIES):
            if len(lines) >= len(parents) + wanted:
                break
            parent = parents[int(rng.integers(len(parents)))]
            at = int(rng.integers(2, len(parent) - 2)) if len(parent) > 6 else len(parent) // 2
            along = parent[min(at + 1, len(parent) - 1)] - parent[at - 1]
            turn = rng.choice((-1.0, 1.0)) * math.radians(rng.uniform(50.0, 100.0))
            heading = math.atan2(along[1], along[0]) + turn
            line = _grow(parent[at], heading, length_m * rng.uniform(0.6, 1.0), size_m, lines, rng)
            if line is not None:
                lines.append(line)
    return lines


def looping(size_m: tuple[float, float], rng: np.random.Generator) -> list[Line]:
    """Draw a ring with a way in, a chord across it, and up to two small rings beside it."""
    edge = min(size_m)
    middle = np.array(size_m) * rng.uniform(0.46, 0.54, 2)
    first = _ring(middle, edge * rng.uniform(0.21, 0.25), rng)
    ways_in = [_way_in(point, middle, size_m) for point in first]
    door = int(np.argmax([len(line) for line in ways_in]))  # from a corner: there is most room
    ring = np.roll(first, -door, axis=0)
    lines = [ways_in[door], np.concatenate([ring, ring[:1]])]
    across = (len(ring) // 2 + int(rng.integers(-4, 5))) % len(ring)
    lines.append(_between(ring[len(ring) // 8], ring[across], rng))
    for _ in range(TRIES):
        if len(lines) >= 5:
            break
        radius = edge * rng.uniform(0.08, 0.11)
        bearing = rng.uniform(-math.pi, math.pi)
        away = _reach(ring, middle, bearing) + radius + 0.5 * APART_M
        place = middle + away * np.array([math.cos(bearing), math.sin(bearing)])
        small = _ring(place, radius, rng)
        if _inside(small, size_m) and _clear(small, _sampled(lines, 0.5)[0], 0.45 * APART_M):
            lines.append(np.concatenate([small, small[:1]]))
    return lines


def patchy(size_m: tuple[float, float], rng: np.random.Generator) -> list[Line]:
    """Draw short pieces of reef, each some 10 m of bare ground away from the others."""
    edge = min(size_m)
    lines = [_first_line(0.25, 10.0, size_m, rng)]
    low, high = min(GAP_M[0], GAP * edge), GAP_M[1]
    wanted, others = round(edge / 5.0), _sampled(lines, 0.5)[0]
    for _ in range(10 * TRIES):
        if len(lines) > wanted:
            break
        bearing = rng.uniform(-math.pi, math.pi)
        away = rng.uniform(low, high) * np.array([math.cos(bearing), math.sin(bearing)])
        begin = others[int(rng.integers(len(others)))] + away
        if not _inside(begin[None], size_m) or not _clear(begin[None], others, low):
            continue
        line = _grow(begin, rng.uniform(-math.pi, math.pi), rng.uniform(4.0, 11.0), size_m, [], rng)
        if line is not None and _inside(line, size_m) and _clear(line, others, low):
            lines.append(line)
            others = _sampled(lines, 0.5)[0]
    return lines


WILD: dict[str, Callable[[tuple[float, float], np.random.Generator], list[Line]]] = {
    "branching": branching,
    "looping": looping,
    "patchy": patchy,
}
"""Topologies whose lines differ from seed to seed."""


def scatter(lines: Sequence[Line], count: int, lead_m: float) -> list[tuple[float, float, float]]:
    """Place points on the lines as far from each other as their number allows, each the farthest from those before.

    The first `lead_m` from the start stay empty. Returns (x, y, direction of the line), in the order of the lines.
    """
    points, yaws = _sampled(lines)
    free = np.flatnonzero(np.hypot(*(points - points[0]).T) >= lead_m)
    if not len(free):
        return []
    chosen = [int(free[np.argmin(np.hypot(*(points[free] - points[0]).T))])]
    away = np.hypot(*(points[free] - points[chosen[0]]).T)
    while len(chosen) < count:
        best = int(free[np.argmax(away)])
        chosen.append(best)
        away = np.minimum(away, np.hypot(*(points[free] - points[best]).T))
    return [(float(points[k, 0]), float(points[k, 1]), float(yaws[k])) for k in sorted(chosen)]


def _sampled(lines: Sequence[Line], step_m: float = 0.1) -> tuple[Line, NDArray[np.float64]]:
    """Points along all lines, Shape=(N, 2), and the direction there, Shape=(N,)."""
    points, yaws = [], []
    for line in lines:
        edges = np.diff(line, axis=0)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(edges[:, 0], edges[:, 1]))])
        at = np.arange(0.0, along[-1], step_m)
        points.append(np.stack([np.interp(at, along, line[:, axis]) for axis in (0, 1)], axis=1))
        edge = np.clip(np.searchsorted(along, at, side="right") - 1, 0, len(edges) - 1)
        yaws.append(np.arctan2(edges[edge, 1], edges[edge, 0]))
    return np.concatenate(points), np.concatenate(yaws)


def _first_line(share: float, length_m: float, size_m: tuple[float, float], rng: np.random.Generator) -> Line:
    """Grow a line about east from within the middle `2 share` of the western border, the longest of several."""
    begin = np.array([BORDER_M, rng.uniform(0.5 - share, 0.5 + share) * size_m[1]])
    return max((_walk(begin, rng.normal(0.0, 0.2), length_m, size_m, [], rng) for _ in range(20)), key=len)


def _grow(
    begin: NDArray[np.float64],
    heading: float,
    length_m: float,
    size_m: tuple[float, float],
    lines: Sequence[Line],
    rng: np.random.Generator,
) -> Line | None:
    """Grow a line, away from the others but where it begins; None if there is no room for two thirds of it."""
    line = _walk(begin, heading, length_m, size_m, lines, rng)
    return line if len(line) - 1 >= max(3, round(0.66 * length_m / STEP_M)) else None


def _walk(
    begin: NDArray[np.float64],
    heading: float,
    length_m: float,
    size_m: tuple[float, float],
    lines: Sequence[Line],
    rng: np.random.Generator,
) -> Line:
    """Walk with a slowly changing bend until the length is reached or there is no room."""
    line, bend = [np.asarray(begin, float)], 0.0
    others = np.concatenate([_sampled([line])[0] for line in lines]) if lines else np.empty((0, 2))
    for k in range(round(length_m / STEP_M)):
        bend = 0.75 * bend + rng.normal(0.0, 0.09)
        heading += bend
        place = line[-1] + STEP_M * np.array([math.cos(heading), math.sin(heading)])
        # Room grows with the distance from the fork, so that a branch can leave its parent at all.
        room = min(APART_M, 0.62 * (k + 1) * STEP_M)
        if not _inside(place[None], size_m) or (len(others) and np.hypot(*(others - place).T).min() < room):
            break
        own = np.array(line[: max(0, len(line) - round(1.5 * APART_M / STEP_M))])
        if len(own) and np.hypot(*(own - place).T).min() < APART_M:
            break
        line.append(place)
    return np.array(line)


def _ring(middle: NDArray[np.float64], radius_m: float, rng: np.random.Generator) -> Line:
    """A closed wobbly curve, open by one piece. Shape=(K, 2)."""
    angles = np.linspace(-math.pi, math.pi, max(12, round(2.0 * math.pi * radius_m / STEP_M)), endpoint=False)
    waves = [rng.uniform(0.0, 0.16 / n) * np.cos(n * angles + rng.uniform(-math.pi, math.pi)) for n in (2, 3, 5)]
    wobble = np.sum(waves, axis=0)
    radii = radius_m * (1.0 + wobble)
    return np.asarray(middle + radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1), np.float64)


def _way_in(door: NDArray[np.float64], middle: NDArray[np.float64], size_m: tuple[float, float]) -> Line:
    """The line to a point of a ring from outside, as far out as there is room."""
    out = (door - middle) / np.hypot(*(door - middle))
    reach = STEP_M
    while reach < 0.3 * min(size_m) and _inside((door + (reach + 0.5) * out)[None], size_m):
        reach += 0.5
    return np.linspace(door + reach * out, door, max(2, math.ceil(reach / STEP_M) + 1))


def _between(a: NDArray[np.float64], b: NDArray[np.float64], rng: np.random.Generator) -> Line:
    """A bent line from one point to another."""
    at = np.linspace(0.0, 1.0, max(4, math.ceil(math.dist(a, b) / STEP_M)))
    across = np.array([a[1] - b[1], b[0] - a[0]])
    bend = rng.uniform(-0.18, 0.18) * np.sin(math.pi * at)
    return np.asarray(a + at[:, None] * (b - a) + bend[:, None] * across, np.float64)


def _reach(ring: Line, middle: NDArray[np.float64], bearing: float) -> float:
    """Distance of a ring from its middle in a direction (m)."""
    towards = ring - middle
    turn = np.abs(np.remainder(np.arctan2(towards[:, 1], towards[:, 0]) - bearing + math.pi, 2 * math.pi) - math.pi)
    return float(np.hypot(*towards[int(np.argmin(turn))]))


def _inside(points: Line, size_m: tuple[float, float]) -> bool:
    return bool(((points >= BORDER_M - 1e-9) & (points <= np.array(size_m) - BORDER_M + 1e-9)).all())


def _clear(points: Line, others: Line, apart_m: float) -> bool:
    """Whether points keep their distance from all others."""
    return bool(np.hypot(*(points[:, None] - others[None]).transpose(2, 0, 1)).min() >= apart_m)
