"""How late the ticks of a stream are."""

from __future__ import annotations

import numpy as np

BIN_MS, BINS = 0.1, 2000


class Lateness:
    """Counts lateness in bins of 0.1 ms, so that a long stream needs no memory."""

    def __init__(self) -> None:
        self._counts = np.zeros(BINS, int)
        self.max_ms = 0.0

    def add(self, late_s: float) -> None:
        """Count a tick that was late by so much (s); an early one counts as on time."""
        late_ms = max(0.0, 1e3 * late_s)
        self._counts[min(int(late_ms / BIN_MS), BINS - 1)] += 1
        self.max_ms = max(self.max_ms, late_ms)

    def percentile_ms(self, share: float) -> float:
        """Return the lateness (ms) that this share of the ticks stays below, rounded up to a bin; 0 without ticks."""
        total = int(self._counts.sum())
        if not total:
            return 0.0
        return min(BIN_MS * (1 + int(np.searchsorted(np.cumsum(self._counts), share * total))), self.max_ms)
