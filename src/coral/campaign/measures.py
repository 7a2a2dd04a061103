"""The measures of a mission in the tables, with their means and differences over a campaign's rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coral.campaign.spec import NO_ADVISOR
from coral.campaign.stats import Estimate, bootstrap_mean, paired_difference

Row = Mapping[str, Any]
Pair = tuple[Hashable, Hashable]
"""World and seed, which pair a variant with the reference."""


@dataclass(frozen=True)
class Measure:
    """A measure of a mission, None if it is undefined."""

    key: str
    label: str
    of: Callable[[Row], float | None]
    digits: int = 1


def field(key: str, label: str, name: str, scale: float = 1.0, digits: int = 1) -> Measure:
    """Make a measure from a column of the data set, times `scale`."""

    def of(row: Row) -> float | None:
        value = row.get(name)
        return None if value is None else scale * float(value)

    return Measure(key, label, of, digits)


def time_to_count(reference: Mapping[Pair, int]) -> Measure:
    """Make a measure: the time (s) at which a mission covered as many clusters as the reference (paper IV-E: K_i).

    None if it never did, if the reference is missing, or if the reference covered nothing.

    Args:
        reference: Final count of the reference for each world and seed.
    """

    def of(row: Row) -> float | None:
        count = reference.get(pair(row), 0)
        times = row.get("covered_at_s") or ()
        return float(times[count - 1]) if 0 < count <= len(times) else None

    return Measure("coverage_time", "coverage time (s)", of, 0)


def pair(row: Row) -> Pair:
    """Return the key by which two rows are compared, within one advisor and one configuration."""
    return row["world"], row["seed"]


def select(rows: Sequence[Row], advisor: str, overrides: str) -> list[Row]:
    """Select finished missions with this advisor, and those without an advisor."""
    return [
        row
        for row in rows
        if row["status"] == "done" and row["advisor"] in (advisor, NO_ADVISOR) and row["overrides"] == overrides
    ]


def values(rows: Sequence[Row], measure: Measure) -> dict[Pair, float]:
    """Return the measure of each mission in which it is defined."""
    found = {pair(row): measure.of(row) for row in rows}
    return {key: value for key, value in found.items() if value is not None}


def mean(rows: Sequence[Row], measure: Measure) -> Estimate:
    """Compute the mean of the measure over missions, with its interval."""
    found = values(rows, measure)
    return bootstrap_mean(list(found.values()), [world for world, _ in found])


def difference(rows: Sequence[Row], reference: Sequence[Row], measure: Measure) -> Estimate:
    """Compute the mean difference from the reference over the pairs that both have."""
    ours = values(rows, measure)
    return paired_difference(ours, values(reference, measure), {key: key[0] for key in ours})


def mean_text(rows: Sequence[Row], measure: Measure) -> str:
    """Format a mean: `97.1`; with `(28/30)` if only 28 of 30 missions have the number; a dash if none has."""
    if not rows:
        return "not run"
    estimate = mean(rows, measure)
    if not estimate.count:
        return "—"
    share = f" ({estimate.count}/{len(rows)})" if estimate.count < len(rows) else ""
    return number(estimate.mean, measure.digits) + share


def mean_interval_text(rows: Sequence[Row], measure: Measure) -> str:
    """Format a mean as `mean_text` does, with its interval: `97.1 [95.0, 99.0]`."""
    estimate = mean(rows, measure)
    if not estimate.count or math.isnan(estimate.low):
        return mean_text(rows, measure)
    low, high = (number(value, measure.digits) for value in (estimate.low, estimate.high))
    return f"{mean_text(rows, measure)} [{low}, {high}]"


def difference_text(estimate: Estimate, digits: int) -> str:
    """Format a difference: `−3.1 [−5.0, −1.2]`, with `≈` in front if the interval contains zero."""
    if not estimate.count:
        return "—"
    text = number(estimate.mean, digits, sign=True)
    if math.isnan(estimate.low):
        return text
    interval = f" [{number(estimate.low, digits, sign=True)}, {number(estimate.high, digits, sign=True)}]"
    return ("" if estimate.tells else "≈ ") + text + interval


def number(value: float, digits: int, *, sign: bool = False) -> str:
    """Format a number with a real minus; zero has no sign."""
    text = f"{value:+.{digits}f}" if sign else f"{value:.{digits}f}"
    if not any(digit in text for digit in "123456789"):
        text = text.lstrip("+-")
    return text.replace("-", "−")
