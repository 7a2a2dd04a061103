"""The paper's pool trial as a world: a round tank with shells in patterns and floating balls (paper IV-B)."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from coral.errors import InputError
from coral.reef.world.geometry import wrap
from coral.reef.world.structures import Obstacle, Tank, Tether
from coral.reef.world.world import Cluster, Oyster, ReefWorld, Start, check_world

PREFIX = "pool:"
RADIUS_M, WATER_M = 1.83, 1.52
"""12 ft across and 5 ft deep (paper IV-B)."""
SIZE_M = 4.1
"""Edge of the survey area, a little more than the tank with its wall."""
BALLS, BALL_M = 3, 0.1
"""Number of the balls and their radius. The paper shows some and counts none."""
FROM_WALL_M = 0.55
"""Distance of the start from the wall: the hull's radius and 0.25 m."""
PASSAGE_M = 0.8
"""Narrowest passage between two balls, and between a ball and the wall: the hull and 0.1 m on either side."""

Spots = list[tuple[float, float, float]]
"""Middles of heaps of shells about the tank's centre (m), and the direction of each (rad)."""


def _line(rng: np.random.Generator) -> Spots:
    return [(s, 0.0, 0.0) for s in (-1.1, 0.0, 1.1)]


def _arc(rng: np.random.Generator) -> Spots:
    angles = (-1.3, 0.0, 1.3, 2.6)
    return [(1.05 * math.cos(a), 1.05 * math.sin(a), a + 0.5 * math.pi) for a in angles]


def _cross(rng: np.random.Generator) -> Spots:
    return [(math.cos(a), math.sin(a), a) for a in np.arange(4) * 0.5 * math.pi]


def _heaps(rng: np.random.Generator) -> Spots:
    found: Spots = []
    while len(found) < 4:
        r, a = 1.25 * math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
        x, y = r * math.cos(a), r * math.sin(a)
        if all(math.hypot(x - u, y - v) > 1.0 for u, v, _ in found):
            found.append((x, y, rng.uniform(-math.pi, math.pi)))
    return found


PATTERNS: dict[str, Callable[[np.random.Generator], Spots]] = {
    "line": _line,
    "arc": _arc,
    "cross": _cross,
    "heaps": _heaps,
}
"""Patterns of shells, in turn by seed. The paper says that there were several, not which."""


@lru_cache(maxsize=32)
def pool(seed: int) -> ReefWorld:
    """Make a pool: pattern, its direction, balls and start pose by `seed`; the same seed makes the same pool."""
    rng = np.random.default_rng([seed, *map(ord, "pool")])
    name = [*PATTERNS][seed % len(PATTERNS)]
    turn, middle = rng.uniform(-math.pi, math.pi), 0.5 * SIZE_M
    c, s = math.cos(turn), math.sin(turn)
    spots = [(c * x - s * y, s * x + c * y, a + turn) for x, y, a in PATTERNS[name](rng)]
    clusters = tuple(_heap(f"c{k}", *spot, rng) for k, spot in enumerate(spots))
    while True:
        angle = rng.uniform(-math.pi, math.pi)
        away = RADIUS_M - FROM_WALL_M
        start = Start(
            x=round(middle + away * math.cos(angle), 3),
            y=round(middle + away * math.sin(angle), 3),
            theta=round(wrap(angle + math.pi + rng.uniform(-0.6, 0.6)), 3),
        )
        balls = _balls(rng, (start.x - middle, start.y - middle))
        if balls is None:
            continue
        world = ReefWorld(
            name=f"pool-{seed}",
            size_m=(SIZE_M, SIZE_M),
            start=start,
            clusters=clusters,
            obstacles=tuple(balls),
            seed=seed,
            water_depth_m=WATER_M,
            tank=Tank(x=middle, y=middle, radius_m=RADIUS_M, height_m=WATER_M),
        )
        try:
            check_world(world, world.name)
        except InputError:
            continue  # a ball shuts a heap off
        return world


def pool_by_name(name: str) -> ReefWorld:
    """Return the pool `pool:SEED`.

    Raises:
        InputError: The seed is not a number of 0 or more.
    """
    text = name.removeprefix(PREFIX)
    if not (text.isascii() and text.isdigit() and len(text) <= 9):
        raise InputError("world", "", repr(name), f"{PREFIX}SEED with a number of 0 or more, such as {PREFIX}0")
    return pool(int(text))


def _heap(name: str, x: float, y: float, direction: float, rng: np.random.Generator) -> Cluster:
    """Draw shells in an ellipse of 0.8 by 0.5 m, a dense layer, as they are poured out."""
    c, s, shells = math.cos(direction), math.sin(direction), list[Oyster]()
    for _ in range(60):
        r, a = math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
        along, across = 0.4 * r * math.cos(a), 0.25 * r * math.sin(a)
        long = rng.uniform(0.04, 0.07)
        radii = (round(long, 3), round(0.7 * long, 3), round(0.35 * long, 3))
        rpy = [round(float(v), 3) for v in (*rng.normal(0.0, 0.3, 2), rng.uniform(-math.pi, math.pi))]
        shells.append(
            Oyster(
                x=round(0.5 * SIZE_M + x + c * along - s * across, 3),
                y=round(0.5 * SIZE_M + y + s * along + c * across, 3),
                z=round(0.6 * radii[2], 3),
                radii=radii,
                rpy=(rpy[0], rpy[1], rpy[2]),
            )
        )
    return Cluster(name=name, oysters=tuple(shells))


def _balls(rng: np.random.Generator, start: tuple[float, float]) -> list[Obstacle] | None:
    """Draw floating balls that leave passages; None if they do not fit."""
    found: list[Obstacle] = []
    for _ in range(200):
        if len(found) == BALLS:
            return found
        r, a = rng.uniform(0.0, RADIUS_M - PASSAGE_M - BALL_M), rng.uniform(-math.pi, math.pi)
        x, y = r * math.cos(a), r * math.sin(a)
        middle = 0.5 * SIZE_M
        apart = [math.hypot(x + middle - o.x, y + middle - o.y) - 2 * BALL_M for o in found]
        if math.dist((x, y), start) < 0.3 + BALL_M + 0.4 or min(apart, default=math.inf) < PASSAGE_M:
            continue
        found.append(
            Obstacle(
                shape="sphere",
                x=round(x + middle, 3),
                y=round(y + middle, 3),
                z=round(rng.uniform(0.7, 1.2), 3),
                size=(BALL_M, BALL_M, BALL_M),
                tether=Tether(),
            )
        )
    return None
