"""The worth of one answer."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Worth:
    """A score and why."""

    score: float
    """From 0 (no use) to 1 (as good as it gets)."""
    why: str
    """In a few words, for the report."""


def share_left(error: float, worthless: float) -> float:
    """1 without an error, 0 from a worthless one on, straight in between; 0 for an error that is no number."""
    return max(0.0, 1.0 - error / worthless) if math.isfinite(error) else 0.0
