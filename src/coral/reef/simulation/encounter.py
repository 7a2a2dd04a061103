"""Contacts between robots: disc against disc. Each contact of a pair counts once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


class Encounters:
    """Counts contacts in the robots' true motion. A contact lasts until the pair is more than `release_m` apart."""

    def __init__(self, radius_m: float = 0.3, release_m: float = 0.05) -> None:
        self.count = 0
        """Contacts so far."""
        self._between, self._release = 2.0 * radius_m, release_m
        self._touching: set[tuple[int, int]] = set()

    def follow(
        self, robot: int, track: NDArray[np.float64], positions: Sequence[tuple[float, float]]
    ) -> list[tuple[float, float, int]]:
        """Move one robot along a track, past the others at their present positions.

        Args:
            robot: Number of the robot that moves.
            track: Positions of its centre, oldest first (m). Shape=(N, 2).
            positions: Positions of all robots (m). Its own is ignored.

        Returns:
            New contacts as (x, y, other): position of its centre (m) and number of the robot that it touches.
        """
        found = []
        for other, (x, y) in enumerate(positions):
            if other == robot:
                continue
            pair = min(robot, other), max(robot, other)
            gaps = np.hypot(track[:, 0] - x, track[:, 1] - y) - self._between
            k = int(np.argmin(gaps))
            if pair in self._touching:
                if gaps[-1] > self._release:
                    self._touching.remove(pair)
            elif gaps[k] <= 0.0:
                self._touching.add(pair)
                self.count += 1
                found.append((float(track[k, 0]), float(track[k, 1]), other))
        return found
