"""The score of one answer."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Worth:
    """A score with its reason."""

    score: float
    """From 0 (useless) to 1 (perfect)."""
    why: str
    """The reason in a few words, for the report."""


def share_left(error: float, worthless: float) -> float:
    """Map an error linearly to a score: 1 for no error, 0 from `worthless` on or if the error is not finite."""
    return max(0.0, 1.0 - error / worthless) if math.isfinite(error) else 0.0
