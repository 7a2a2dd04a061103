"""Makes reef worlds: clusters grown along a spine, obstacles dense at the start and interspersed later (paper IV-A)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.reachability import unreachable_clusters
from coral.reef.world import Cluster, Current, Obstacle, Oyster, ReefWorld, Start

Line = NDArray[np.float64]
Topology = Literal["L", "S", "K", "E", "O"]


def _circle() -> list[tuple[float, float]]:
    angles = np.linspace(-0.5 * math.pi, 1.5 * math.pi, 49)
    return [(0.5 + 0.29 * math.cos(a), 0.52 + 0.29 * math.sin(a)) for a in angles]


SPINES: dict[Topology, list[list[tuple[float, float]]]] = {
    "L": [[(0.12, 0.22), (0.76, 0.22), (0.76, 0.86)]],
    "S": [[(0.12, 0.20), (0.45, 0.17), (0.68, 0.22), (0.76, 0.33), (0.70, 0.44), (0.50, 0.50), (0.30, 0.56),
           (0.24, 0.67), (0.32, 0.78), (0.55, 0.83), (0.84, 0.80)]],
    "K": [[(0.22, 0.10), (0.22, 0.88)], [(0.22, 0.47), (0.76, 0.85)], [(0.22, 0.47), (0.76, 0.13)]],
    "E": [[(0.20, 0.08), (0.20, 0.86)], [(0.20, 0.20), (0.74, 0.20)], [(0.20, 0.53), (0.74, 0.53)],
          [(0.20, 0.86), (0.74, 0.86)]],
    "O": [[(0.12, 0.23), (0.5, 0.23), *_circle()[1:]]],
}
"""Spines in units of the world's size; the robot starts at the first point of the first line."""


@dataclass(frozen=True, kw_only=True)
class GeneratorCfg:
    """What a generated reef is like. Lengths in metres; the paper gives only the size range and the topologies."""

    topology: Topology = "S"
    spine: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Polylines (m) to grow the reef along in place of a topology."""
    size_m: tuple[float, float] = (22.0, 22.0)
    """The paper's range is 20 to 30."""
    clusters: int = 7
    """The paper's percentages are those of 70 clusters in 10 environments."""
    oysters: tuple[int, int] = (40, 85)
    """Range of the number of oysters in a cluster."""
    dense_obstacles: int = 20
    """Obstacles within `dense_radius_m` in front of the start, or as many as leave passages; at least half of them."""
    dense_radius_m: float = 6.5
    obstacles: int = 34
    """Obstacles beyond it, most of them along the spine; the same holds."""
    passage_m: float = 1.0
    """Narrowest gap between two obstacles: the robot's diameter and 0.2 m on either side."""
    current_max_m_s: float = 0.08
    seed: int = 0


def generate(cfg: GeneratorCfg, name: str = "") -> ReefWorld:
    """Grow a reef; the same configuration gives the same world.

    Raises:
        InputError: The configuration asks for more than fits, or a value is out of range.
    """
    _check(cfg)
    rng = np.random.default_rng([cfg.seed, *map(ord, cfg.topology)])
    scale = np.array(cfg.size_m)
    lines = [np.array(line, float) for line in cfg.spine] or [np.array(s) * scale for s in SPINES[cfg.topology]]
    start = lines[0][0]
    heading = math.atan2(*(lines[0][1] - start)[::-1])
    beds = _beds(cfg, lines, rng)
    clusters = tuple(_cluster(f"c{k}", bed, cfg, rng) for k, bed in enumerate(beds))
    obstacles = _obstacles(cfg, lines, beds, start, heading, rng)
    direction, speed = rng.uniform(-math.pi, math.pi), rng.uniform(0.0, cfg.current_max_m_s)
    world = ReefWorld(
        name=name or f"{cfg.topology.lower()}-{cfg.seed}", topology="custom" if cfg.spine else cfg.topology,
        size_m=cfg.size_m, start=Start(x=_mm(start[0]), y=_mm(start[1]), theta=_mm(heading)),
        current=Current(x_m_s=_mm(speed * math.cos(direction)), y_m_s=_mm(speed * math.sin(direction))),
        clusters=clusters, obstacles=obstacles, seed=cfg.seed,
        spine=tuple(tuple((_mm(x), _mm(y)) for x, y in line) for line in lines))
    missing = unreachable_clusters(world)
    if missing:
        raise InputError("generator", "obstacles", f"{len(world.obstacles)} that cut off {world.clusters[missing[0]].name}",
                         "fewer obstacles or a wider passage_m")
    return world


@dataclass(frozen=True)
class _Bed:
    """Outline of one cluster: an ellipse."""

    x: float
    y: float
    yaw: float
    length: float
    width: float
    """Half-axes (m)."""


def _check(cfg: GeneratorCfg) -> None:
    def demand(field: str, good: bool, found: object, expected: str) -> None:
        if not good:
            raise InputError("generator", field, found, expected)

    demand("topology", cfg.topology in SPINES, repr(cfg.topology), f"one of {', '.join(SPINES)}")
    demand("size_m", all(8.0 <= s <= 100.0 for s in cfg.size_m), cfg.size_m, "edges from 8 to 100 m")
    demand("clusters", 1 <= cfg.clusters <= 60, cfg.clusters, "1 to 60")
    demand("oysters", 1 <= cfg.oysters[0] <= cfg.oysters[1] <= 500, cfg.oysters, "a range within 1 to 500")
    demand("obstacles", 0 <= cfg.obstacles + cfg.dense_obstacles <= 500 and min(cfg.obstacles, cfg.dense_obstacles) >= 0,
           cfg.obstacles + cfg.dense_obstacles, "0 to 500")
    demand("passage_m", 0.8 <= cfg.passage_m <= 5.0, cfg.passage_m, "0.8 to 5 m")
    demand("current_max_m_s", 0.0 <= cfg.current_max_m_s <= 0.5, cfg.current_max_m_s, "0 to 0.5 m/s")
    demand("seed", cfg.seed >= 0, cfg.seed, "a number from 0 on")
    for i, line in enumerate(cfg.spine):
        demand(f"spine[{i}]", len(line) >= 2, f"{len(line)} points", "at least 2 points")
        for j, (x, y) in enumerate(line):
            inside = 0.5 <= x <= cfg.size_m[0] - 0.5 and 0.5 <= y <= cfg.size_m[1] - 0.5
            demand(f"spine[{i}][{j}]", inside, f"({x:g}, {y:g})", "a point at least 0.5 m inside size_m")


def _samples(lines: Sequence[Line], step: float = 0.1) -> tuple[Line, NDArray[np.float64]]:
    """Points every `step` metres along the lines, Shape=(N, 2), and the line's direction there, Shape=(N,)."""
    points, yaws = [], []
    for line in lines:
        for a, b in zip(line[:-1], line[1:], strict=True):
            length = float(np.linalg.norm(b - a))
            for s in np.arange(0.0, length, step):
                points.append(a + (b - a) * s / length)
                yaws.append(math.atan2(b[1] - a[1], b[0] - a[0]))
        points.append(line[-1])
        yaws.append(yaws[-1])
    return np.array(points), np.array(yaws)


def _beds(cfg: GeneratorCfg, lines: Sequence[Line], rng: np.random.Generator) -> list[_Bed]:
    """Spread the clusters evenly over the whole spine: each next one lies farthest from those before."""
    points, yaws = _samples(lines)
    start = lines[0][0]
    lead = float(np.clip(0.14 * min(cfg.size_m), 2.0, 4.0))
    away = np.linalg.norm(points - start, axis=1)
    inside = np.all((points > 1.9) & (points < np.array(cfg.size_m) - 1.9), axis=1) & (away >= lead)
    if not inside.any():
        raise InputError("generator", "spine", "no room for a cluster", f"a spine that goes on for {lead:.1f} m or more")
    chosen = [int(np.argmin(np.where(inside, away, np.inf)))]
    while len(chosen) < cfg.clusters:
        gap = np.min(np.linalg.norm(points[:, None] - points[chosen][None], axis=2), axis=1)
        best = int(np.argmax(np.where(inside, gap, -1.0)))
        if gap[best] < 3.0:
            raise InputError("generator", "clusters", cfg.clusters,
                             f"at most {len(chosen)} on this spine (3 m between neighbours)")
        chosen.append(best)
    nearest = [min((float(np.linalg.norm(points[i] - points[j])) for j in chosen if j != i), default=9.0)
               for i in chosen]
    order = sorted(range(len(chosen)), key=lambda k: chosen[k])
    beds = []
    for k in order:
        i = chosen[k]
        most = min(1.35, (nearest[k] - 1.3) / 2)
        length = rng.uniform(0.75, 1.0) * most
        beds.append(_Bed(x=points[i, 0] + rng.uniform(-0.15, 0.15), y=points[i, 1] + rng.uniform(-0.15, 0.15),
                         yaw=yaws[i] + rng.uniform(-0.3, 0.3), length=length, width=length * rng.uniform(0.5, 0.8)))
    return beds


def _cluster(name: str, bed: _Bed, cfg: GeneratorCfg, rng: np.random.Generator) -> Cluster:
    """Oysters of random size and pose in a bed, denser about a few settlement spots."""
    spots = rng.uniform(-0.6, 0.6, (int(rng.integers(2, 5)), 2))
    oysters = []
    for _ in range(int(rng.integers(cfg.oysters[0], cfg.oysters[1] + 1))):
        while True:
            p = spots[rng.integers(len(spots))] + rng.normal(0.0, 0.35, 2) if rng.random() < 0.6 else rng.uniform(-1, 1, 2)
            if p @ p <= 1.0:
                break
        dx, dy = p[0] * bed.length, p[1] * bed.width
        c, s = math.cos(bed.yaw), math.sin(bed.yaw)
        a = rng.uniform(0.06, 0.13)
        radii = (_mm(a), _mm(a * rng.uniform(0.6, 0.85)), _mm(a * rng.uniform(0.4, 0.7)))
        rpy = (_mm(rng.normal(0.0, 0.35)), _mm(rng.normal(0.0, 0.35)), _mm(rng.uniform(-math.pi, math.pi)))
        oysters.append(Oyster(x=_mm(bed.x + c * dx - s * dy), y=_mm(bed.y + s * dx + c * dy), z=_mm(0.6 * radii[2]),
                              radii=radii, rpy=rpy))
    return Cluster(name=name, oysters=tuple(oysters))


def _obstacles(cfg: GeneratorCfg, lines: Sequence[Line], beds: Sequence[_Bed], start: Line, heading: float,
               rng: np.random.Generator) -> tuple[Obstacle, ...]:
    """Rocks, posts and debris that leave passages of at least `passage_m` and keep clear of start and oysters."""
    points, _ = _samples(lines)
    size = np.array(cfg.size_m)
    placed: list[tuple[float, float, float]] = []
    made: list[Obstacle] = []

    def gap(x: float, y: float, r: float) -> float:
        return min((math.hypot(x - px, y - py) - r - pr for px, py, pr in placed), default=math.inf)

    def fits(x: float, y: float, r: float) -> bool:
        forward = (x - start[0]) * math.cos(heading) + (y - start[1]) * math.sin(heading)
        clear = math.hypot(x - start[0], y - start[1]) - r
        edge = min(x, y, size[0] - x, size[1] - y) - r
        beside = all(math.hypot(x - b.x, y - b.y) > r + b.length + 0.15 for b in beds)
        return edge > 0.3 and clear > (1.2 if forward > 0 else 0.9) and beside and gap(x, y, r) >= cfg.passage_m

    def place(count: int, field: str, propose: bool) -> None:
        wanted = len(made) + count
        for _ in range(1500 * count):
            if len(made) == wanted:
                return
            shape, half, r = _solid(rng)
            if propose:
                radius = cfg.dense_radius_m * math.sqrt(rng.random())
                angle = heading + rng.uniform(-0.5 * math.pi, 0.5 * math.pi)
                x, y = start[0] + radius * math.cos(angle), start[1] + radius * math.sin(angle)
            elif rng.random() < 0.8:
                spot = points[rng.integers(len(points))]
                x, y = spot + rng.normal(0.0, 2.0, 2)
            else:
                x, y = rng.uniform(0.0, 1.0, 2) * size
            if not propose and math.hypot(x - start[0], y - start[1]) < cfg.dense_radius_m:
                continue
            crowded = gap(x, y, r) <= cfg.passage_m + 0.5 or len(made) < 2 or rng.random() < 0.15
            if fits(x, y, r) and (crowded or not propose):
                placed.append((x, y, r))
                made.append(Obstacle(shape=shape, x=_mm(x), y=_mm(y), z=half[2] if shape != "sphere" else _mm(half[2] * 0.9),
                                     size=half, yaw=_mm(rng.uniform(-math.pi, math.pi))))
        if len(made) < wanted - count // 2:
            raise InputError("generator", field, count, f"at most {2 * (len(made) - wanted + count)} in this world")

    place(cfg.dense_obstacles, "dense_obstacles", True)
    place(cfg.obstacles, "obstacles", False)
    return tuple(made)


def _solid(rng: np.random.Generator) -> tuple[Literal["sphere", "ellipsoid", "cylinder", "box"],
                                              tuple[float, float, float], float]:
    """Shape, half-extents (m) and the radius of the circle about its outline; all taller than the vehicle's keel."""
    kind = rng.random()
    if kind < 0.30:
        a, b, c = _mm(rng.uniform(0.25, 0.5)), _mm(rng.uniform(0.2, 0.45)), _mm(rng.uniform(0.62, 0.9))
        return "ellipsoid", (a, b, c), max(a, b)
    if kind < 0.40:
        a = _mm(rng.uniform(0.62, 0.72))
        return "sphere", (a, a, a), a
    if kind < 0.75:
        a = _mm(rng.uniform(0.1, 0.3))
        return "cylinder", (a, a, _mm(rng.uniform(0.7, 1.3))), a
    a, b = _mm(rng.uniform(0.15, 0.45)), _mm(rng.uniform(0.1, 0.3))
    return "box", (a, b, _mm(rng.uniform(0.62, 0.9))), math.hypot(a, b)


def _mm(value: float) -> float:
    return round(float(value), 3)


SHIPPED: dict[str, GeneratorCfg] = {
    "l1": GeneratorCfg(topology="L", size_m=(20.0, 20.0), clusters=6, obstacles=34, seed=11),
    "l2": GeneratorCfg(topology="L", size_m=(26.0, 26.0), clusters=7, obstacles=50, seed=12),
    "s1": GeneratorCfg(topology="S", size_m=(22.0, 22.0), clusters=7, obstacles=40, seed=21),
    "s2": GeneratorCfg(topology="S", size_m=(28.0, 28.0), clusters=8, obstacles=56, seed=22),
    "k1": GeneratorCfg(topology="K", size_m=(22.0, 22.0), clusters=7, obstacles=40, seed=31),
    "k2": GeneratorCfg(topology="K", size_m=(28.0, 28.0), clusters=8, obstacles=56, seed=32),
    "e1": GeneratorCfg(topology="E", size_m=(22.0, 22.0), clusters=8, obstacles=40, seed=41),
    "e2": GeneratorCfg(topology="E", size_m=(30.0, 30.0), clusters=9, obstacles=60, seed=42),
    "o1": GeneratorCfg(topology="O", size_m=(22.0, 22.0), clusters=7, obstacles=40, seed=51),
    "o2": GeneratorCfg(topology="O", size_m=(28.0, 28.0), clusters=8, obstacles=56, seed=52),
}
"""The ten environments: two of each topology, the second larger."""


def shipped(name: str) -> tuple[ReefWorld, str]:
    """One of the ten environments, made anew, and the comment at the head of its file."""
    cfg = SHIPPED[name]
    comment = (f"{name}: {cfg.topology}-shaped reef, {cfg.size_m[0]:g} x {cfg.size_m[1]:g} m.\n"
               f"Metres, radians; world frame ENU, z up. Made by coral.reef.generate.shipped({name!r}).")
    return generate(cfg, name), comment
