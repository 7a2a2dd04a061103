"""Growing curves, thinned to a size that can be drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

POINTS = 400
"""Points of a curve on the page: more than its pixels."""


class History:
    """Samples of several values over time; when full, it drops every second one and thins later ones alike."""

    def __init__(self, names: Sequence[str], *, limit: int = 2 * POINTS) -> None:
        self.names = tuple(names)
        self._rows = np.zeros((limit, len(names) + 1))
        self._n = 0
        self._stride = 1
        self._offered = 0

    def add(self, t: float, *values: float) -> None:
        """Add a sample at time `t` (s); nan for missing values."""
        self._offered += 1
        if (self._offered - 1) % self._stride:
            return
        if self._n == len(self._rows):
            self._n = (self._n + 1) // 2
            self._rows[: self._n] = self._rows[::2]
            self._stride *= 2
            if (self._offered - 1) % self._stride:
                return
        self._rows[self._n] = (t, *values)
        self._n += 1

    def curves(self, names: Sequence[str]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return times, Shape=(N,), and values, Shape=(len(names), N), of some of the curves; copies."""
        columns = [1 + self.names.index(name) for name in names]
        rows = self._rows[: self._n]
        return rows[:, 0].copy(), rows[:, columns].T.copy()


def thinned(t: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Thin recorded curves to at most `POINTS` samples, keeping the last one. Shapes (N,), (S, N)."""
    if len(t) <= POINTS:
        return t, values
    keep = np.linspace(0, len(t) - 1, POINTS).round().astype(np.intp)
    return t[keep], values[:, keep]
