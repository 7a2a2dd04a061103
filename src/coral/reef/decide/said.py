"""What the advisor of a mission in words said of things. It stays with their places: labels of dots change."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

SAME_M = 1.0
"""Dots this near to each other are one and the same, under whatever label."""
WHY_CHARACTERS = 300


@dataclass(frozen=True, kw_only=True)
class Said:
    """What was said of one thing."""

    dot: int
    """Its label when that was said."""
    x: float
    y: float
    label: str = ""
    """What it is; empty: nobody said."""
    skip: bool = False
    """Whether it is ruled out."""
    why: str = ""
    """Reason of the answer that said it last."""

    @property
    def name(self) -> str:
        """What a map writes beside it."""
        return (self.label or "?")[:32] + ", ruled out" * self.skip

    @classmethod
    def of_record(cls, record: object) -> Said | None:
        """Return what a run's event holds; None if it is not of that form."""
        if not isinstance(record, Mapping):
            return None
        numbers = [record.get(key) for key in ("dot", "x", "y")]
        if not all(isinstance(n, int | float) and math.isfinite(n) for n in numbers):
            return None
        dot, x, y = (float(n) for n in numbers if n is not None)
        label, why = str(record.get("label") or ""), str(record.get("why") or "")
        return cls(dot=int(dot), x=x, y=y, label=label, skip=bool(record.get("skip")), why=why)


def of_place(said: Iterable[Said], x: float, y: float) -> Said | None:
    """Return what was said of the thing at a place (m); None if nothing was."""
    near = [one for one in said if math.dist((one.x, one.y), (x, y)) <= SAME_M]
    return min(near, key=lambda one: math.dist((one.x, one.y), (x, y)), default=None)


def with_said(said: Sequence[Said], new: Said) -> tuple[Said, ...]:
    """Return all that was said with something new. A label replaces the old one; what is ruled out stays so."""
    old = of_place(said, new.x, new.y)
    if old is None:
        return (*said, new)
    merged = replace(new, label=new.label or old.label, skip=new.skip or old.skip)
    return tuple(merged if one is old else one for one in said)


def records_of(said: Iterable[Said]) -> list[dict[str, Any]]:
    """Return what a run's event holds of it."""
    return [asdict(one) | {"x": round(one.x, 2), "y": round(one.y, 2)} for one in said]


def said_by(events: Iterable[Mapping[str, Any]], t: float = math.inf) -> list[Said]:
    """Return what had been said by a time (s) of a run, from its events."""
    told = [e["said"] for e in events if isinstance(e.get("said"), list) and float(e["t"]) <= t + 1e-6]
    found = (Said.of_record(record) for record in (told[-1] if told else ()))
    return [one for one in found if one is not None]
