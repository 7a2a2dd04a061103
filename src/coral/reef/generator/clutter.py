"""Obstacles of a generated reef: a dense field ahead of the start, the rest among the clusters (paper IV-A)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.world.world import Obstacle

Shape = Literal["sphere", "ellipsoid", "cylinder", "box"]

_TRIES, _MOST_TRIES = 400, 12_000
"""Draws per obstacle, and in all, after which the area counts as full."""
_RESTARTS = 4
"""Times that the dense field is begun when some of it finds no room."""
_ROW_M = 3.5
"""Half the length of a row of posts across the reef."""
_EDGE_M, _BESIDE_OYSTERS_M, _BEHIND_START_M, _AHEAD_OF_START_M = 0.3, 0.3, 0.9, 1.2
"""Least distance of an obstacle's circle from the world's edge, from an oyster, behind the start and ahead of it."""


@dataclass(frozen=True, kw_only=True)
class Room:
    """The world before obstacles are placed. Metres, radians."""

    size_m: tuple[float, float]
    start: tuple[float, float, float]
    points: NDArray[np.float64]
    """Points on the spine. Shape=(N, 2)."""
    oysters: NDArray[np.float64]
    """x, y and radius of every oyster on the ground plane. Shape=(M, 3)."""


class Clutter:
    """Places obstacles one by one so that a passage remains between any two.

    An obstacle counts as the circle about its outline, so no passage is narrower than `passage_m`. Circles grown by
    half a passage do not touch each other: the space left for a hull of that radius is connected.
    """

    def __init__(self, room: Room, passage_m: float, rng: np.random.Generator) -> None:
        self.room, self.passage_m, self._rng = room, passage_m, rng
        self.placed: list[Obstacle] = []
        self._circles: list[tuple[float, float, float]] = []
        self._kept = 0
        """Obstacles that stay when the dense field is begun again."""

    def rows(self, crossings: NDArray[np.float64]) -> None:
        """Place rows of posts across the reef; the gap between two neighbours is the passage and up to 0.1 m more.

        `crossings`, Shape=(N, 3), are x, y (m) and direction (rad) of the spine at the middle of each row.

        Raises:
            InputError: None of them finds room.
        """
        before = len(self.placed)
        for x, y, heading in crossings.tolist():
            along = np.array([-math.sin(heading), math.cos(heading)])
            # A gap lies on the spine itself, so that the reef leads through the row.
            gap = self.passage_m + self._rng.uniform(0.01, 0.1)
            for side in (-1.0, 1.0):
                at = 0.5 * gap
                while at < _ROW_M:
                    radius = mm(self._rng.uniform(0.2, 0.4))
                    px, py = (mm(v) for v in np.array([x, y]) + side * (at + radius) * along)
                    self._post(px, py, radius)
                    at += 2.0 * radius + self.passage_m + self._rng.uniform(0.01, 0.1)
        if len(crossings) and len(self.placed) == before:
            raise InputError("--barriers", "", len(crossings), "0 here")
        self._kept = len(self.placed)

    def _post(self, x: float, y: float, radius: float) -> None:
        """Place a post unless something is in the way."""
        near = any(math.hypot(x - a, y - b) - radius - r < self.passage_m for a, b, r in self._circles)
        if near or not self._fits(x, y, radius):
            return
        height = mm(self._rng.uniform(0.7, 1.3))
        self._circles.append((x, y, radius))
        self.placed.append(Obstacle(shape="cylinder", x=x, y=y, z=height, size=(radius, radius, height)))

    def field(self, count: int, radius_m: float) -> None:
        """Place the dense field ahead of the start, most obstacles as close to a neighbour as the passage allows.

        Raises:
            InputError: Fewer than half of them fit.
        """
        x0, y0, heading = self.room.start

        def draw() -> tuple[float, float]:
            radius = radius_m * math.sqrt(self._rng.random())
            angle = heading + self._rng.uniform(-0.5 * math.pi, 0.5 * math.pi)
            return x0 + radius * math.cos(angle), y0 + radius * math.sin(angle)

        for _ in range(_RESTARTS):
            del self.placed[self._kept :], self._circles[self._kept :]
            if self._place(count, draw, crowd=True, beyond_m=0.0):
                break
        self._demand_half(count, len(self.placed) - self._kept, "--dense-obstacles")

    def along(self, count: int, beyond_m: float) -> None:
        """Place obstacles beyond `beyond_m` from the start: four in five near the spine, the others anywhere.

        Raises:
            InputError: Fewer than half of them fit.
        """
        room, rng = self.room, self._rng

        def draw() -> tuple[float, float]:
            if rng.random() < 0.8:
                x, y = room.points[rng.integers(len(room.points))] + rng.normal(0.0, 1.8, 2)
            else:
                x, y = rng.uniform(0.0, 1.0, 2) * room.size_m
            return float(x), float(y)

        if count and not np.any(np.hypot(*(room.points - room.start[:2]).T) >= beyond_m):
            raise InputError("--obstacles", "", count, f"0 on a spine that stays within {beyond_m:g} m of its start")
        before = len(self.placed)
        self._place(count, draw, crowd=False, beyond_m=beyond_m)
        self._demand_half(count, len(self.placed) - before, "--obstacles")

    def _demand_half(self, count: int, done: int, flag: str) -> None:
        if 2 * done < count:
            raise InputError(flag, "", count, f"at most {2 * done} with passages of {self.passage_m:g} m here")

    def _place(self, count: int, draw: Callable[[], tuple[float, float]], *, crowd: bool, beyond_m: float) -> bool:
        """Place up to `count` obstacles. Return whether all of them fit."""
        before, tries = len(self.placed), min(_TRIES * count, _MOST_TRIES)
        for attempt in range(tries):
            if len(self.placed) == before + count:
                return True
            shape, half, radius = _solid(self._rng, slim=2 * attempt > tries)
            x, y = draw()
            if math.hypot(x - self.room.start[0], y - self.room.start[1]) < beyond_m:
                continue
            gap = self._gap(x, y, radius)
            narrow = gap <= self.passage_m + 0.4 or len(self.placed) < 2 or self._rng.random() < 0.15
            if gap < self.passage_m or (crowd and not narrow) or not self._fits(x, y, radius):
                continue
            self._circles.append((x, y, radius))
            # A rock is sunk in a little, so that it does not stand on a point.
            z = half[2] if shape in ("box", "cylinder") else 0.9 * half[2]
            self.placed.append(
                Obstacle(
                    shape=shape, x=mm(x), y=mm(y), z=mm(z), size=half, yaw=mm(self._rng.uniform(-math.pi, math.pi))
                )
            )
        return len(self.placed) == before + count

    def _gap(self, x: float, y: float, radius: float) -> float:
        """Distance (m) of a circle to the nearest placed one, or to the first that is too near."""
        gap = math.inf
        for a, b, r in self._circles:
            gap = min(gap, math.hypot(x - a, y - b) - radius - r)
            if gap < self.passage_m:
                break
        return gap

    def _fits(self, x: float, y: float, radius: float) -> bool:
        room = self.room
        x0, y0, heading = room.start
        ahead = (x - x0) * math.cos(heading) + (y - y0) * math.sin(heading) > 0
        if math.hypot(x - x0, y - y0) - radius < (_AHEAD_OF_START_M if ahead else _BEHIND_START_M):
            return False
        if min(x, y, room.size_m[0] - x, room.size_m[1] - y) - radius < _EDGE_M:
            return False
        away = np.hypot(room.oysters[:, 0] - x, room.oysters[:, 1] - y) - room.oysters[:, 2]
        return bool(away.min() >= radius + _BESIDE_OYSTERS_M)


def _solid(rng: np.random.Generator, slim: bool) -> tuple[Shape, tuple[float, float, float], float]:
    """Draw a rock, post or piece of debris. Return its shape, half-extents (m) and bounding radius on the ground (m).

    With `slim`, when space is scarce, it is always a thin post. All stand on the seabed and are at least 1.2 m high:
    the vehicle's camera is 1 m above the seabed.
    """
    if slim:
        return "cylinder", (0.08, 0.08, mm(rng.uniform(0.7, 1.3))), 0.08
    kind = rng.random()
    if kind < 0.35:
        a, b, c = mm(rng.uniform(0.25, 0.55)), mm(rng.uniform(0.2, 0.45)), mm(rng.uniform(0.64, 0.9))
        return "ellipsoid", (a, b, c), max(a, b)
    if kind < 0.42:
        a = mm(rng.uniform(0.64, 0.7))
        return "sphere", (a, a, a), a
    if kind < 0.77:
        a = mm(rng.uniform(0.08, 0.25))
        return "cylinder", (a, a, mm(rng.uniform(0.7, 1.3))), a
    a, b = mm(rng.uniform(0.15, 0.45)), mm(rng.uniform(0.1, 0.3))
    return "box", (a, b, mm(rng.uniform(0.62, 0.9))), math.hypot(a, b)


def mm(value: float) -> float:
    """Round to the precision of a world file: millimetres or milliradians."""
    return round(float(value), 3)
