"""Contacts between robots: disc against disc, each pair counted once for each contact."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


class Encounters:
    """Tracks all robots' true motion; a contact lasts until the pair is more than `release_m` apart again."""

    def __init__(self, radius_m: float = 0.3, release_m: float = 0.05) -> None:
        self.count = 0
        """Contacts so far."""
        self._between, self._release = 2.0 * radius_m, release_m
        self._touching: set[tuple[int, int]] = set()

    def follow(
        self, robot: int, track: NDArray[np.float64], positions: Sequence[tuple[float, float]]
    ) -> list[tuple[float, float, int]]:
        """Move one robot along a track, Shape=(N, 2), metres, past the others at their present positions.

        Args:
            robot: Which one moves.
            track: Positions of its centre, oldest first.
            positions: Of every robot (m); its own is not looked at.

        Returns:
            New contacts as (x, y, other): where its centre was (m), and which robot it began to touch.
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
