"""Validation of a run folder's records before anything is drawn from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

LONGEST_S = 1e7
"""Maximum plausible time (s): four months."""
LARGEST = 1e9
"""Maximum plausible number elsewhere."""

NUMBERS = frozenset((
    "t", "step", "decision", "attempt", "index", "asked_at", "asked_at_s", "answered_at_s", "x", "y", "fraction",
    "deviation_m", "obstacle", "clusters_total", "force_n", "newtons", "begun_s", "ended_s", "peak_n", "mean_n",
    "attempts", "reach_m",
))  # fmt: skip
"""Fields with a number, or null if there is none."""
LISTS = frozenset(("pictures", "centroids", "captions"))
NEEDED = {
    "goal": ("x", "y"),
    "collision": ("x", "y"),
    "sight": ("reach_m",),
    "guess": ("hit",),
    "stage": ("stage",),
    "contact": ("first", "second", "force_n"),
    "contact_end": ("first", "second", "begun_s", "ended_s"),
}
"""Required fields of each kind of event."""
FIGURES = frozenset((
    "coverage", "clusters_covered", "clusters_total", "collisions", "advisor_calls", "requeries", "deviations", "steps",
    "sim_time_s", "distance_m",
))  # fmt: skip
"""Metrics that the headline and the tiles use as numbers."""


def is_number(value: object) -> bool:
    """Check whether a value is a number that can be drawn: finite and of plausible size."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST


def sound(record: Mapping[str, Any]) -> bool:
    """Check whether every field of an event or an attempt has the right type."""
    if any(record.get(name) is None for name in NEEDED.get(str(record.get("event")), ())):
        return False
    for name, value in record.items():
        if value is None and name != "t":
            continue
        if name in NUMBERS and not is_number(value):
            return False
        if name in LISTS and not isinstance(value, list):
            return False
    if not 0 <= record.get("t", 0.0) <= LONGEST_S:
        return False
    return all(map(_is_caption, record.get("captions") or ())) and all(map(_is_spot, record.get("centroids") or ()))


def figures(metrics: Mapping[str, Any]) -> dict[str, Any]:
    """Return the metrics without those that should be numbers and are not."""
    return {key: value for key, value in metrics.items() if key not in FIGURES or is_number(value)}


def is_extent(size: object) -> bool:
    """Check whether a value is a map's width and height (m)."""
    return isinstance(size, list | tuple) and len(size) == 2 and all(is_number(s) and 0 < s <= 10_000 for s in size)


def _is_caption(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(part, str) for part in value)


def _is_spot(value: object) -> bool:
    return isinstance(value, dict) and all(is_number(value[key]) for key in ("index", "x", "y") if key in value)
