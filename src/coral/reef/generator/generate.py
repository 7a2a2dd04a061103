"""Generator of reef worlds: clusters along a spine, obstacles dense at the start and scattered after (paper IV-A)."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from coral.errors import InputError, shown
from coral.reef.generator.clutter import Clutter, Room, mm
from coral.reef.generator.spines import EVERY_TOPOLOGY, Line, Topology, samples, spread, topology_lines
from coral.reef.generator.wild_spines import WILD, scatter
from coral.reef.world.world import Cluster, Current, Oyster, ReefWorld, Start, check_world

_APART_M = 3.0
"""Between the middles of two clusters at least, so that a gap of 1.2 m or more stays between their outlines."""
_EVERY_M, _EVERY_IN_PATCHES_M = 6.0, 4.0
"""Of the spine for each cluster where their number is left open; a patch of 8 m has two."""
_LONGEST_NAME, _MOST = 60, 60
"""Letters of a world's name; clusters."""
_SETTLE_M = 0.2
"""Largest gap between an oyster and its nearest neighbour, so that a cluster is one patch on the robot's map."""
DENSE_RADIUS_M, CURRENT_MAX_M_S = 6.5, 0.08
"""Reach of the dense field ahead of the start, and the fastest water."""
_BORDER_M = 1.9
"""Least distance between the centre of a cluster and the world's edge."""


@dataclass(frozen=True, kw_only=True)
class GeneratorCfg:
    """Settings of a generated reef. Lengths in metres. The paper gives only the size range and the topologies."""

    topology: Topology = "S"
    spine: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Polylines (m) along which the reef grows, in place of a topology."""
    size_m: tuple[float, float] = (22.0, 22.0)
    """Width and height. The paper's range is 20 to 30."""
    clusters: int = 7
    """Number of oyster clusters. The paper has 70 in 10 environments.
    0: one for every 6 m of the spine, 4 m in patches."""
    oysters: tuple[int, int] = (48, 88)
    """Range of the number of oysters in a cluster."""
    dense_obstacles: int = 20
    """Number of obstacles within `DENSE_RADIUS_M` ahead of the start. Fewer if they would close passages, but
    at least half."""
    obstacles: int = 34
    """Number of obstacles farther from the start than `DENSE_RADIUS_M`, most of them along the spine. Fewer if they
    would close passages, but at least half."""
    barriers: int = 0
    """Rows of posts across the reef, with gaps of `passage_m` to 0.1 m more. The paper has none."""
    passage_m: float = 1.0
    """Narrowest gap between two obstacles: the robot's diameter and 0.2 m on either side. 0.8 is the least."""
    seed: int = 0


def generate(cfg: GeneratorCfg, name: str = "") -> ReefWorld:
    """Generate a reef. The same configuration gives the same world.

    Raises:
        InputError: The configuration asks for more than fits, or a value is out of range. It names the flag of
            `coral reef generate`.
    """
    _check(cfg)
    name = name or f"{'custom' if cfg.spine else cfg.topology.lower()}-{cfg.seed}"
    if len(name) > _LONGEST_NAME:
        raise InputError("generator", "name", shown(name), f"at most {_LONGEST_NAME} letters")
    rng = np.random.default_rng([cfg.seed, *map(ord, cfg.topology)])
    lines = [np.array(line, float) for line in cfg.spine] or topology_lines(cfg.topology, cfg.size_m, rng)
    start = lines[0][0]
    heading = math.atan2(*(lines[0][1] - start)[::-1])
    clusters = tuple(_cluster(f"c{k}", bed, cfg, rng) for k, bed in enumerate(_beds(cfg, lines, rng)))
    clutter = Clutter(
        Room(
            size_m=cfg.size_m,
            start=(start[0], start[1], heading),
            points=samples(lines),
            oysters=np.array([(o.x, o.y, max(o.radii)) for group in clusters for o in group.oysters]),
        ),
        cfg.passage_m,
        rng,
    )
    if cfg.barriers:
        clutter.rows(_crossings(clusters, lines, cfg.barriers, DENSE_RADIUS_M))
    clutter.field(cfg.dense_obstacles, DENSE_RADIUS_M)
    clutter.along(cfg.obstacles, DENSE_RADIUS_M)
    direction, speed = rng.uniform(-math.pi, math.pi), rng.uniform(0.0, CURRENT_MAX_M_S)
    world = ReefWorld(
        name=name,
        topology="custom" if cfg.spine else cfg.topology,
        size_m=cfg.size_m,
        start=Start(x=mm(start[0]), y=mm(start[1]), theta=mm(heading)),
        current=Current(x_m_s=mm(speed * math.cos(direction)), y_m_s=mm(speed * math.sin(direction))),
        clusters=clusters,
        obstacles=tuple(clutter.placed),
        seed=cfg.seed,
        spine=tuple(tuple((mm(x), mm(y)) for x, y in line) for line in lines),
    )
    check_world(world, "generator")
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
    def demand(flag: str, good: bool, found: object, expected: str, point: str = "") -> None:
        if not good:
            raise InputError(flag, point, found, expected)

    demand("--topology", cfg.topology in EVERY_TOPOLOGY, repr(cfg.topology), f"one of {', '.join(EVERY_TOPOLOGY)}")
    demand("--size-m", all(8.0 <= s <= 100.0 for s in cfg.size_m), cfg.size_m, "edges from 8 to 100 m")
    least = len(cfg.spine or ((),) if cfg.topology in WILD else topology_lines(cfg.topology, cfg.size_m))
    demand(
        "--clusters",
        cfg.clusters == 0 or least <= cfg.clusters <= _MOST,
        cfg.clusters,
        f"{least} (one for each line of the spine) to 60",
    )
    demand("--oysters", 1 <= cfg.oysters[0] <= cfg.oysters[1] <= 500, cfg.oysters, "a range within 1 to 500")
    demand("--dense-obstacles", 0 <= cfg.dense_obstacles <= 500, cfg.dense_obstacles, "0 to 500")
    demand("--obstacles", 0 <= cfg.obstacles <= 500, cfg.obstacles, "0 to 500")
    demand("--barriers", 0 <= cfg.barriers <= 50, cfg.barriers, "0 to 50")
    demand("--passage-m", 0.8 <= cfg.passage_m <= 5.0, cfg.passage_m, "0.8 to 5 m")
    demand("--seed", 0 <= cfg.seed < 2**63, cfg.seed, "a number of 0 or more")
    wide, high = cfg.size_m
    expected = f"a point at least 0.5 m inside --size-m, {wide:g} x {high:g} m"
    for line in cfg.spine:
        demand("--polyline", len(line) >= 2, f"{len(line)} points", "at least 2 points")
        for number, (x, y) in enumerate(line, 1):
            inside = 0.5 <= x <= wide - 0.5 and 0.5 <= y <= high - 0.5
            demand("--polyline", inside, f"({x:g}, {y:g})", expected, f"point {number}")


def _beds(cfg: GeneratorCfg, lines: Sequence[Line], rng: np.random.Generator) -> list[_Bed]:
    """Spread beds evenly over the spine, except for its first few metres."""
    lead = float(np.clip(0.14 * min(cfg.size_m), 2.0, 4.0))
    if np.hypot(*np.diff(lines[0], axis=0).T).sum() <= lead:
        raise InputError("--polyline", "", "no room for a cluster", f"a first line longer than {lead:.1f} m")
    count = cfg.clusters or _count(cfg, lines, lead)
    places, away = _places(cfg, lines, count, lead)
    if away.min() < _APART_M:
        fit = next(
            (n for n in range(count - 1, len(lines) - 1, -1) if _places(cfg, lines, n, lead)[1].min() >= _APART_M), 0
        )
        raise InputError("--clusters", "", count, f"at most {fit} on this spine, {_APART_M:g} m between neighbours")
    beds = []
    for (x, y, yaw), nearest in zip(places, away, strict=True):
        length = rng.uniform(0.75, 1.0) * min(1.35, (nearest - 1.3) / 2)
        beds.append(
            _Bed(
                x=x + rng.uniform(-0.15, 0.15),
                y=y + rng.uniform(-0.15, 0.15),
                yaw=yaw + rng.uniform(-0.3, 0.3),
                length=length,
                width=length * rng.uniform(0.5, 0.8),
            )
        )
    return beds


def _count(cfg: GeneratorCfg, lines: Sequence[Line], lead_m: float) -> int:
    """Choose the number of clusters from the spine's length; every line gets one, and none lies too near another."""
    length = sum(float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in lines)
    every = _EVERY_IN_PATCHES_M if cfg.topology == "patchy" and not cfg.spine else _EVERY_M
    count = min(max(len(lines), round(length / every)), _MOST)
    while count > len(lines) and _places(cfg, lines, count, lead_m)[1].min() < _APART_M:
        count -= 1
    return count


def _places(cfg: GeneratorCfg, lines: Sequence[Line], count: int, lead_m: float) -> tuple[Line, Line]:
    """Choose middles and directions of `count` clusters, Shape=(N, 3), and the distance to the nearest, Shape=(N,)."""
    wild = cfg.topology in WILD and not cfg.spine
    places = np.array(scatter(lines, count, lead_m) if wild else spread(lines, count, lead_m))
    places[:, :2] = np.clip(places[:, :2], _BORDER_M, np.array(cfg.size_m) - _BORDER_M)
    away = np.hypot(*(places[:, None, :2] - places[None, :, :2]).transpose(2, 0, 1))
    np.fill_diagonal(away, 9.0)
    return places, away.min(axis=1)


def _crossings(clusters: Sequence[Cluster], lines: Sequence[Line], count: int, from_m: float) -> Line:
    """Choose where rows cross the reef: midway between neighbours on the spine, the farthest apart of them first.

    x, y and the spine's direction of each, Shape=(N, 3); N is less than `count` where the reef has fewer gaps.
    """
    middles = np.array([np.mean([(o.x, o.y) for o in cluster.oysters], axis=0) for cluster in clusters])
    points = samples(lines)
    ahead = np.roll(points, -1, axis=0) - points
    away = np.hypot(*(points[:, None] - middles[None]).transpose(2, 0, 1)).min(axis=1)
    inside = np.hypot(*ahead.T) < 0.5  # not where one line ends and the next one begins
    open_ = inside & (away > 2.0) & (np.hypot(*(points - lines[0][0]).T) > from_m + 1.5)
    chosen: list[int] = []
    while len(chosen) < count and open_.any():
        best = int(np.argmax(np.where(open_, away, -1.0)))
        chosen.append(best)
        open_ &= np.hypot(*(points - points[best]).T) > 5.0
    return np.array([(*points[k], math.atan2(ahead[k, 1], ahead[k, 0])) for k in chosen]).reshape(-1, 3)


def _cluster(name: str, bed: _Bed, cfg: GeneratorCfg, rng: np.random.Generator) -> Cluster:
    """Draw oysters of random size and pose in a bed, denser around a few spots; each lies near an earlier one."""
    spots = rng.uniform(-0.6, 0.6, (int(rng.integers(2, 5)), 2))
    c, s = math.cos(bed.yaw), math.sin(bed.yaw)
    oysters: list[Oyster] = []
    reach: list[tuple[float, float, float]] = []
    for _ in range(int(rng.integers(cfg.oysters[0], cfg.oysters[1] + 1))):
        a = rng.uniform(0.06, 0.13)
        radii = (mm(a), mm(a * rng.uniform(0.6, 0.85)), mm(a * rng.uniform(0.4, 0.7)))
        while True:
            near_spot = rng.random() < 0.6
            p = spots[rng.integers(len(spots))] + rng.normal(0.0, 0.35, 2) if near_spot else rng.uniform(-1, 1, 2)
            if p @ p > 1.0:
                continue
            forward, left = p[0] * bed.length, p[1] * bed.width
            x, y = bed.x + c * forward - s * left, bed.y + s * forward + c * left
            if not reach or any(math.hypot(x - u, y - v) < r + radii[1] + _SETTLE_M for u, v, r in reach):
                break
        reach.append((x, y, radii[1]))
        rpy = (mm(rng.normal(0.0, 0.35)), mm(rng.normal(0.0, 0.35)), mm(rng.uniform(-math.pi, math.pi)))
        oysters.append(Oyster(x=mm(x), y=mm(y), z=mm(0.6 * radii[2]), radii=radii, rpy=rpy))
    return Cluster(name=name, oysters=tuple(oysters))


def command_line(cfg: GeneratorCfg, out: str) -> str:
    """Return the command that generates a reef again, with every setting that is not the default."""
    words = ["coral reef generate"]
    for field in fields(cfg):
        value = getattr(cfg, field.name)
        if field.name == "spine" and len(value) == 1:
            words.append(f"--polyline '{json.dumps(value[0], separators=(',', ':'))}'")
        elif value != field.default or field.name in ("topology", "seed"):
            many = value if isinstance(value, tuple) else (value,)
            words.append(f"--{field.name.replace('_', '-')} {' '.join(map(_word, many))}")
    return " ".join([*words, f"--out {out}"])


def _word(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


SHIPPED: dict[str, GeneratorCfg] = {
    "l1": GeneratorCfg(topology="L", size_m=(20.0, 20.0), clusters=6, obstacles=34, seed=11),
    "l2": GeneratorCfg(topology="L", size_m=(26.0, 26.0), clusters=7, obstacles=50, seed=12),
    "s1": GeneratorCfg(topology="S", size_m=(22.0, 22.0), clusters=8, obstacles=40, seed=21),
    "s2": GeneratorCfg(topology="S", size_m=(27.0, 27.0), clusters=9, obstacles=56, seed=22),
    "k1": GeneratorCfg(topology="K", size_m=(22.0, 22.0), clusters=7, obstacles=40, seed=31),
    "k2": GeneratorCfg(topology="K", size_m=(26.0, 26.0), clusters=9, obstacles=56, seed=32),
    "e1": GeneratorCfg(topology="E", size_m=(22.0, 22.0), clusters=9, obstacles=40, seed=41),
    "e2": GeneratorCfg(topology="E", size_m=(30.0, 30.0), clusters=9, obstacles=60, seed=42),
    "o1": GeneratorCfg(topology="O", size_m=(22.0, 22.0), clusters=7, obstacles=40, seed=51),
    "o2": GeneratorCfg(topology="O", size_m=(26.0, 26.0), clusters=8, obstacles=56, seed=52),
}
"""Settings of the ten environments: two of each topology, the second one larger."""
