"""The experience memory (Eq. 1): successful plans, retrieved by goals, numbers and wording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError, field_validator

from coral.contact.memory.goal_match import (
    HELD,
    GoalMatch,
    fits_hand,
    joints_of,
    match_goals,
    roles,
    scene_distance,
    scene_numbers,
    translate_numbers,
)
from coral.contact.memory.store_sqlite import Row, SqliteStore
from coral.contact.memory.wording import Vector, contradict, embed
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.scene.facts import SceneFacts
from coral.errors import InputError


class RememberedPlan(BaseModel):
    """A plan, and where it touches."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    plan: PlanAnswer
    regions: RegionsAnswer


class Experience(BaseModel):
    """One success."""

    model_config = ConfigDict(extra="forbid")
    task: str
    instruction: str
    """The task."""
    goals: list[dict[str, Any]]
    """The task file's conditions."""
    numbers: dict[str, FiniteFloat]
    """Measurements of the scene, by name: sizes, heights, distances."""
    plan: PlanAnswer
    regions: RegionsAnswer
    """The plan that it began with, and its regions."""
    then: list[RememberedPlan] = Field(default_factory=list)
    """The repairs that replaced it on the way to the success, in order."""
    beliefs: dict[str, tuple[FiniteFloat, FiniteFloat]]
    """Believed mass (kg) and friction of each object at the end."""
    provenance: dict[str, Any]
    """Origin of the success: world, seed, variant, advisor, run, metrics."""

    @field_validator("goals")
    @classmethod
    def _of_objects(cls, goals: list[dict[str, Any]]) -> list[dict[str, Any]]:
        # The fields used for retrieval; the other fields of a goal only have to be equal.
        if not all(isinstance(goal.get(key), str) for goal in goals for key in ("kind", "object")):
            raise ValueError("a goal has a kind and an object")
        return goals


@dataclass(frozen=True, kw_only=True)
class Stored(Row):
    """An experience in the memory: a row whose record was read."""

    experience: Experience

    @property
    def success_rate(self) -> float:
        """Return the expected share of its uses that succeed, counting its first success (rule of succession)."""
        return (self.helped + 2) / (self.used + 3)


@dataclass(frozen=True)
class Match:
    """A remembered experience that matches the scene."""

    stored: Stored
    similarity: float
    """Cosine similarity of the instructions."""
    distance: float
    """Largest difference of the numbers, relative to the limit."""
    goals: GoalMatch
    """How its goals correspond to those of the scene."""


CANDIDATES = 3
"""Maximum number of remembered plans that are adapted and checked."""
FAILURES = 3
"""A plan that failed this often without ever succeeding again is no longer offered."""


@dataclass(frozen=True, kw_only=True)
class MemoryCfg:
    """How experiences are retrieved."""

    rehearsed: Annotated[int, Field(ge=0)] = 3
    """Maximum number of plans tried in an imagined run. 0 follows the first that passes its checks, untried."""


class Memory:
    """Stores experiences and retrieves them from an SQLite file, created at the first success.

    Departs from the paper: it recalls by the meaning of task and scene. Here the conditions of the task file have to be
    of the same kinds, and numbers of the scene and wording choose among what is left, so that no plan for another
    goal is offered; under `--variant paper`, too.
    """

    def __init__(self, where: str | Path) -> None:
        self.store = SqliteStore(Path(where))
        self.where = self.store.name
        """The location of the store, as a user writes it."""

    def add(self, experience: Experience) -> int:
        """Store a success; return its id.

        Raises:
            InputError: The experience is not a verified success, or the store cannot be written.
        """
        if not _is_verified(experience):
            expected = "success: true and the world that it was judged in"
            raise InputError("memory", "provenance", dict(experience.provenance), expected)
        return self.store.insert(datetime.now(UTC).isoformat(timespec="seconds"), experience.model_dump_json())

    def all(self) -> list[Stored]:
        """Return every readable experience, oldest first; a file of somebody else's is checked as what `add` stores."""
        found = []
        for row in self.store.rows():
            try:
                experience = Experience.model_validate_json(row.record)
            except ValidationError:
                continue  # written by another version: stays in the store, unused
            if _is_verified(experience):
                found.append(Stored(**vars(row), experience=experience))
        return found

    def get(self, number: int) -> Stored:
        """Return one experience.

        Raises:
            InputError: There is none with this id.
        """
        for stored in self.all():
            if stored.id == number:
                return stored
        raise InputError(self.where, "id", number, f"one of {', '.join(str(s.id) for s in self.all()) or 'none'}")

    def forget(self, number: int) -> None:
        """Remove one experience.

        Raises:
            InputError: There is none with this id.
        """
        self.get(number)
        self.store.delete(number)

    def used(self, number: int, helped: bool) -> None:
        """Record that an experience was used, and whether the episode succeeded."""
        self.store.count(number, helped)

    def find(self, facts: SceneFacts) -> list[Match]:
        """Find the experiences that match a scene, best first.

        The goals have to be of the same kinds, directions and manner; the instructions must not contradict each other;
        sizes, masses, heights and places may differ within limits, but what had to fit the hand still has to. Of those
        that are left, similar wording, success in earlier uses and similar numbers come first. No similarity of the
        wording is required: a paraphrase may share no word.
        """
        here = embed(facts["instruction"])
        found = []
        for stored in self.all():
            if stored.used - stored.helped >= FAILURES and not stored.helped:
                continue
            match = self._match(stored, facts, here)
            if match is not None:
                found.append(match)

        def rank(match: Match) -> tuple[bool, float, int]:
            stored = match.stored
            # A plan that failed more often than it helped comes after all others.
            failed = stored.used - stored.helped > stored.helped
            score = match.similarity + stored.success_rate - 0.5 * match.distance - 0.2 * len(match.goals.missing)
            return (failed, -score, -stored.id)

        return sorted(found, key=rank)[:CANDIDATES]

    def _match(self, stored: Stored, facts: SceneFacts, here: Vector) -> Match | None:
        """Compare an experience with the scene; None if its plan cannot serve."""
        held, numbers = stored.experience, scene_numbers(facts)
        goals = match_goals(
            held.goals, facts["goals"], joints_of(held.numbers, held.goals), joints_of(numbers, facts["goals"])
        )
        if goals is None or contradict(held.instruction, facts["instruction"]):
            return None
        before = translate_numbers(held.numbers, held.goals, facts["goals"], goals.names)
        distance = scene_distance(before, numbers, frozenset(goals.names.values()))
        if distance > 1.0 or not _still_fits_hand(held, goals, before, numbers, facts):
            return None
        similarity = float(np.dot(here, embed(held.instruction)))
        return Match(stored, round(similarity, 4), round(distance, 4), goals)


def open_existing(file: str | Path) -> Memory:
    """Open a memory that exists.

    Raises:
        InputError: There is none.
    """
    memory = Memory(file)
    if not memory.store.exists():
        raise InputError(str(file), "", "no such file", "what coral contact run --memory has made")
    return memory


def _is_verified(experience: Experience) -> bool:
    """Check that an experience is a success, judged in a world that it names."""
    return experience.provenance.get("success") is True and bool(experience.provenance.get("world"))


def _still_fits_hand(
    held: Experience, goals: GoalMatch, before: Mapping[str, float], numbers: Mapping[str, float], facts: SceneFacts
) -> bool:
    """Check that every object that was grasped between the fingers can be grasped so here."""
    regions = [held.regions, *(step.regions for step in held.then)]
    pinched = {name for one in regions for name, region in one.each() if region.approach == "pinch"}
    gripped = pinched | {goal["object"] for goal in held.goals if goal["kind"] in HELD}
    keys = {name: f"object{index}" for index, name in enumerate(roles(facts["goals"]))}
    here = [keys[goals.names[name]] for name in gripped if goals.names.get(name) in keys]
    return all(fits_hand(numbers, key) or not fits_hand(before, key) for key in here)
