"""Finds the one entry that spoils a fit: without it, the others agree."""

from __future__ import annotations

from collections.abc import Callable, Sequence


def find_wrong_entry(residual: Callable[[Sequence[int]], float], count: int, limit: float) -> int | None:
    """Return the index of the entry without which the fit is within its limit; None if it is no single one.

    Args:
        residual: Fits some of the entries, and returns what the fit leaves.
        count: Number of entries.
        limit: Largest residual of a good fit.
    """
    left = [(residual([i for i in range(count) if i != k]), k) for k in range(count)]
    best, wrong = min(left)
    return wrong if best <= limit else None
