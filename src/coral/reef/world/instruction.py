"""A mission in words: its instruction, and conditions that tell in the world's truth whether it was fulfilled."""

from __future__ import annotations

import math
import re
from abc import abstractmethod
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field

from coral.errors import InputError
from coral.reef.world.kinds import find_kind
from coral.reef.world.structures import Metres, WorldPart
from coral.words import many

APART_RAD = math.radians(60.0)
"""Two pictures are of different sides when they were taken from directions this far apart."""
MOST_CHARACTERS = 1000
"""Of an instruction."""
NUMBERS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


@dataclass(frozen=True, kw_only=True)
class Deeds:
    """What a mission did, in truth."""

    kinds: Mapping[str, str]
    """Kind of each thing by its name."""
    inspected_s: Mapping[str, float] = field(default_factory=dict)
    """When each thing that was inspected was seen from near for the first time (s)."""
    nearest_m: Mapping[str, float] = field(default_factory=dict)
    """Least distance of the vehicle's middle from the outline of each thing (m)."""
    seen_from: Mapping[str, Collection[tuple[float, float]]] = field(default_factory=dict)
    """Distances (m) and directions (rad), as seen from each thing, from which it was photographed."""
    end_s: float = 0.0
    from_start_m: float = 0.0
    """Distance from the start at the end (m)."""
    from_m: Mapping[str, float] = field(default_factory=dict)
    """Distance from the middle of each thing at the end (m)."""
    done: bool = False
    """Whether the advisor ended the mission itself."""
    answer: str | None = None
    """What it answered."""

    def of(self, kinds: Collection[str]) -> list[str]:
        """Return the names of the things of these kinds, or of these names."""
        return [name for name, kind in self.kinds.items() if kind in kinds or name in kinds]


class Fulfilment(WorldPart):
    """Whether a condition was met, and by what."""

    condition: str
    met: bool
    found: str


class BaseClause(WorldPart):
    """A condition of a mission. `of`: kinds of `kinds.yaml`, or names of things."""

    @abstractmethod
    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """Tell whether it was met, and what was found."""


class Inspected(BaseClause):
    """At least this share of these things was inspected, or this number of them."""

    kind: Literal["inspected"] = "inspected"
    of: tuple[str, ...] = Field(min_length=1)
    share: float = Field(default=1.0, gt=0, le=1)
    count: int | None = Field(default=None, ge=1)

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        wanted = deeds.of(self.of)
        seen = sum(name in deeds.inspected_s for name in wanted)
        need = math.ceil(self.share * len(wanted) - 1e-9) if self.count is None else self.count
        return seen >= need, f"{seen} of {len(wanted)}, {need} wanted"


class Spared(BaseClause):
    """At most this many of all other things that look like oysters to the robot were inspected."""

    kind: Literal["spared"] = "spared"
    besides: tuple[str, ...] = Field(min_length=1)
    at_most: int = Field(default=0, ge=0)

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        likely = {name for name, kind in deeds.kinds.items() if find_kind(kind).class_ == "oyster"}
        false = (likely & set(deeds.inspected_s)) - set(deeds.of(self.besides))
        return len(false) <= self.at_most, f"{many(len(false), 'other')} inspected, {self.at_most} allowed"


class KeptOff(BaseClause):
    """The vehicle's middle never came nearer than this to the outline of these things."""

    kind: Literal["kept_off"] = "kept_off"
    of: tuple[str, ...] = Field(min_length=1)
    distance_m: Metres

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        near = min((deeds.nearest_m.get(name, math.inf) for name in deeds.of(self.of)), default=math.inf)
        return near >= self.distance_m, f"{near:.2f} m, {self.distance_m:g} m wanted"


class Sides(BaseClause):
    """One of these things was photographed from this many sides, from no farther than this."""

    kind: Literal["sides"] = "sides"
    of: tuple[str, ...] = Field(min_length=1)
    count: int = Field(ge=2, le=6)
    within_m: Metres = 5.0

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        views = (deeds.seen_from.get(name, ()) for name in deeds.of(self.of))
        most = max((apart([angle for m, angle in each if m <= self.within_m]) for each in views), default=0)
        return most >= self.count, f"{many(most, 'side')}, {self.count} wanted"


class InOrder(BaseClause):
    """These things, or some thing of each of these kinds, were inspected one after the other."""

    kind: Literal["in_order"] = "in_order"
    of: tuple[str, ...] = Field(min_length=2)

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        times = [
            min((deeds.inspected_s.get(n, math.inf) for n in deeds.of([one])), default=math.inf) for one in self.of
        ]
        met = times[-1] < math.inf and all(a < b for a, b in pairwise(times))
        return met, ", ".join("never" if t == math.inf else f"{t:.0f} s" for t in times)


class EndsAt(BaseClause):
    """The mission ended within this of the start, or of the middle of a thing of this kind."""

    kind: Literal["ends_at"] = "ends_at"
    at: str = "start"
    within_m: Metres = 2.5

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        things = [deeds.from_m[name] for name in deeds.of([self.at])]
        near = deeds.from_start_m if self.at == "start" else min(things, default=math.inf)
        return near <= self.within_m, f"{near:.1f} m away, {self.within_m:g} m allowed"


class DoneBy(BaseClause):
    """The advisor said by this time that the mission is done."""

    kind: Literal["done_by"] = "done_by"
    time_s: float = Field(gt=0, le=3600)

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        said = f"done at {deeds.end_s:.0f} s" if deeds.done else "not said"
        return deeds.done and deeds.end_s <= self.time_s, f"{said}, {self.time_s:g} s allowed"


class Answered(BaseClause):
    """The answer names one of these words or numbers, and none of the wrong ones."""

    kind: Literal["answered"] = "answered"
    right: tuple[str, ...] = Field(min_length=1)
    wrong: tuple[str, ...] = ()

    def judge(self, deeds: Deeds) -> tuple[bool, str]:
        """See `BaseClause.judge`."""
        words = spoken(deeds.answer or "")
        right = any(word in words for word in self.right) and not any(word in words for word in self.wrong)
        if all(word.isdigit() for word in self.right):  # a number is right alone
            right = right and all(not word.isdigit() or word in self.right for word in words)
        return right, f"{deeds.answer or 'no answer'!r}, {' or '.join(self.right)} is right"


Clause = Annotated[
    Inspected | Spared | KeptOff | Sides | InOrder | EndsAt | DoneBy | Answered, Field(discriminator="kind")
]


class MissionText(WorldPart):
    """What a mission is to do, in plain words, and when that is done in truth."""

    instruction: str = Field(min_length=1, max_length=MOST_CHARACTERS)
    """The words, at most 1,000 characters."""
    time_s: float = Field(default=150.0, gt=0, le=3600)
    """Time after which the mission ends."""
    conditions: tuple[Clause, ...] = Field(min_length=1, max_length=10)
    """1 to 10 conditions, each with its `kind`."""

    def judge(self, deeds: Deeds) -> list[Fulfilment]:
        """Judge every condition."""
        judged = [(clause, clause.judge(deeds)) for clause in self.conditions]
        return [Fulfilment(condition=clause.kind, met=met, found=found) for clause, (met, found) in judged]


def apart(angles: Collection[float]) -> int:
    """Count the directions (rad) that can be chosen so that any two are `APART_RAD` apart or more."""
    best, turn = 0, 2.0 * math.pi
    for first in angles:
        last, count = 0.0, 1
        for offset in sorted((angle - first) % turn for angle in angles):
            if offset - last >= APART_RAD - 1e-9 and turn - offset >= APART_RAD - 1e-9:
                last, count = offset, count + 1
        best = max(best, count)
    return best


def checked_words(words: str, where: str = "--instruction") -> str:
    """Return an instruction that a person gives.

    Raises:
        InputError: It is empty or too long.
    """
    if not words.strip() or len(words) > MOST_CHARACTERS:
        raise InputError(where, "", f"{len(words)} characters", f"some words, at most {MOST_CHARACTERS} characters")
    return words.strip()


def spoken(text: str) -> list[str]:
    """Return the words of an answer in small letters, numbers as digits."""
    words = re.findall(r"[a-z]+|\d+", text.lower())
    return [str(NUMBERS.index(word)) if word in NUMBERS else word for word in words]
