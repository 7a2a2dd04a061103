"""The experience memory (Eq. 1): successful plans, retrieved by task and by numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, FiniteFloat, ValidationError, field_validator

from coral.config import Fraction, Positive
from coral.contact.memory.embedding import Embedder, Vector, best_embedder
from coral.contact.memory.store import ExperienceStore, store_of
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.scene.facts import SceneFacts
from coral.errors import InputError

FORMAT = "coral-memory/1"


class Experience(BaseModel):
    """One success.

    Args:
        task, instruction: The task.
        goals: The task file's conditions.
        numbers: Measurements of the scene, by name (`box.size_m.0`, `box.mass_kg`).
        plan, regions: The successful plan and its regions.
        beliefs: Believed mass and friction at the end.
        provenance: Origin of the success: world, seed, variant, advisor, run, metrics.
    """

    model_config = ConfigDict(extra="forbid")
    task: str
    instruction: str
    goals: list[dict[str, Any]]
    numbers: dict[str, FiniteFloat]
    plan: PlanAnswer
    regions: RegionsAnswer
    beliefs: dict[str, tuple[FiniteFloat, FiniteFloat]]
    provenance: dict[str, Any]

    @field_validator("goals")
    @classmethod
    def _of_objects(cls, goals: list[dict[str, Any]]) -> list[dict[str, Any]]:
        # The fields used for retrieval; the other fields of a goal only have to be equal.
        if not all(isinstance(goal.get(key), str) for goal in goals for key in ("kind", "object")):
            raise ValueError("a goal has a kind and an object")
        return goals


@dataclass(frozen=True)
class Stored:
    """An experience in the memory, with the number of its uses and of the uses that ended in success."""

    id: int
    """Its number."""
    created: str
    """Time of storage, UTC."""
    experience: Experience
    """The experience."""
    used: int
    helped: int
    """Number of uses, and number of uses that ended in success."""
    embedder: str
    """Name of the embedder of the vector."""
    vector: Vector = field(compare=False, repr=False)
    """Embedding of the instruction, Shape=(n,); vectors of different embedders are not comparable."""


@dataclass(frozen=True)
class Match:
    """A remembered experience that matches the scene."""

    stored: Stored
    """The stored experience."""
    similarity: float
    """Cosine similarity of the instructions."""
    distance: float
    """Largest difference of the numbers, relative to the limit."""


@dataclass(frozen=True, kw_only=True)
class MemoryCfg:
    """Limits within which an experience matches."""

    similarity: Fraction = 0.5
    """Smallest cosine similarity of the instructions."""
    size_factor: Positive = 1.35
    mass_factor: Positive = 4.0
    friction_factor: Positive = 2.5
    """Largest factor between the numbers."""
    number_factor: Positive = 1.3
    """The same for the numbers of the goals (heights, forces, tolerances) and of the task."""
    place_m: Positive = 0.08
    """Largest distance between places, or between fixtures."""


class Memory:
    """Stores experiences and retrieves them.

    Args:
        where: The SQLite file, or another string for `store_of`; created at the first success.
        cfg: Limits within which an experience matches.
        embedder: Embeds texts; by default the best one installed.
    """

    def __init__(self, where: str | Path, cfg: MemoryCfg | None = None, embedder: Embedder | None = None) -> None:
        self.store: ExperienceStore = store_of(where)
        self.cfg, self.embedder = cfg or MemoryCfg(), embedder or best_embedder()

    @property
    def where(self) -> str:
        """Return the location of the store, as a user writes it."""
        return self.store.name

    def add(self, experience: Experience) -> int:
        """Store a success; return its id.

        Raises:
            InputError: The experience is not a verified success, or the store cannot be written.
        """
        if experience.provenance.get("success") is not True or not experience.provenance.get("world"):
            raise InputError(
                "memory", "provenance", dict(experience.provenance), "success: true and the world that it was judged in"
            )
        now = datetime.now(UTC).isoformat(timespec="seconds")
        return self.store.insert(
            now, experience.model_dump_json(), self.embedder.name, self.embedder.embed(experience.instruction)
        )

    def all(self) -> list[Stored]:
        """Return every readable experience, oldest first."""
        found = []
        for row in self.store.rows():
            try:
                found.append(
                    Stored(
                        row.id,
                        row.created,
                        Experience.model_validate_json(row.record),
                        row.used,
                        row.helped,
                        row.embedder,
                        row.vector,
                    )
                )
            except ValidationError:
                continue  # written by another version: stays in the store, unused
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

    def find(self, facts: SceneFacts, most: int = 3) -> list[Match]:
        """Find the experiences that match a scene, best first: same goals, similar numbers, then similar texts.

        Args:
            facts: The scene (`scene_facts`).
            most: Maximum number of matches.
        """
        goals, numbers = facts["goals"], scene_numbers(facts)
        candidates = []
        for stored in self.all():
            held = stored.experience
            distance = (
                _distance(held.numbers, numbers, self.cfg)
                if _goal_structure(held.goals) == _goal_structure(goals)
                else math.inf
            )
            if distance <= 1.0:
                candidates.append((stored, distance))
        here = self.embedder.embed(facts["instruction"])
        found = []
        for stored, distance in candidates:
            there = self._vector(stored, len(here))
            similarity = float(np.dot(here, there))
            if similarity >= self.cfg.similarity:
                found.append(Match(stored, round(similarity, 4), round(distance, 4)))

        def rank(match: Match) -> tuple[float, int]:
            # An experience that was used without success ranks lower.
            luck = (match.stored.helped + 1) / (match.stored.used + 1)
            return (-(match.similarity - 0.5 * match.distance + 0.3 * luck), -match.stored.id)

        return sorted(found, key=rank)[:most]

    def _vector(self, stored: Stored, size: int) -> Vector:
        """Return the stored embedding, or a new one if another embedder made it."""
        if stored.embedder == self.embedder.name and len(stored.vector) == size:
            return stored.vector
        return self.embedder.embed(stored.experience.instruction)

    def export(self) -> dict[str, Any]:
        """Return all experiences as JSON."""
        return {
            "format": FORMAT,
            "experiences": [
                {"created": stored.created, **stored.experience.model_dump(mode="json")} for stored in self.all()
            ],
        }

    def load(self, content: Mapping[str, Any], where: str) -> int:
        """Import the result of `export`; return how many experiences were new.

        Raises:
            InputError: The content is not an export, or one of its experiences is invalid.
        """
        if content.get("format") != FORMAT or not isinstance(content.get("experiences"), list):
            raise InputError(where, "format", content.get("format"), FORMAT)
        known = {stored.experience.model_dump_json() for stored in self.all()}
        count = 0
        for index, item in enumerate(content["experiences"]):
            try:
                one = Experience.model_validate({key: value for key, value in dict(item).items() if key != "created"})
                text = one.model_dump_json()
                Experience.model_validate_json(text)  # store only what can be read back
            except (ValidationError, TypeError, ValueError, RecursionError) as error:
                path, why = f"experiences[{index}]", str(error)
                if isinstance(error, ValidationError):
                    first = error.errors(include_url=False)[0]
                    path, why = ".".join([path, *map(str, first["loc"])]), first["msg"]
                raise InputError(where, path, why, "an exported experience") from None
            if text not in known:
                self.add(one)
                known.add(text)
                count += 1
        return count


def scene_numbers(facts: SceneFacts) -> dict[str, float]:
    """Return the numbers of a scene by name, objects identified by their order in the goals, not by their names."""
    order = {name: index for index, name in enumerate(roles(facts))}
    found: dict[str, float] = {}
    for name, item in facts["objects"].items():
        if name not in order:
            continue
        key = f"object{order[name]}"
        found |= {f"{key}.size.{k}": float(value) for k, value in enumerate(item["size_m"])}
        if "mass_kg" in item:
            found[f"{key}.mass_kg"] = float(item["mass_kg"])
        if "friction" in item:
            found[f"{key}.friction"] = float(item["friction"])
    for index, goal in enumerate(facts["goals"]):
        found |= {
            f"goal{index}.{key}": float(value)
            for key, value in goal.items()
            if isinstance(value, int | float) and not isinstance(value, bool)
        }
    found |= {f"number.{key}": float(value) for key, value in facts["numbers"].items()}
    for name, fixture in facts["fixtures"].items():
        found |= {f"place.{name}.{k}": float(value) for k, value in enumerate(fixture["position"])}
    for name, place in facts["places"].items():
        found |= {f"place.{name}.{k}": float(value) for k, value in enumerate(place)}
    return found


def roles(facts: SceneFacts) -> list[str]:
    """Return the objects that the goals move, in the order of the goals."""
    return list(dict.fromkeys(goal["object"] for goal in facts["goals"] if goal["kind"] != "undisturbed"))


def _goal_structure(goals: Sequence[Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """Return the goals without numbers and names: their kinds, the roles of their objects, and their other words."""
    order = {name: f"object{k}" for k, name in enumerate(dict.fromkeys(goal["object"] for goal in goals))}
    return [
        (
            goal["kind"],
            order[goal["object"]],
            *(
                f"{key}={value}"
                for key, value in sorted(goal.items())
                if isinstance(value, str) and key not in ("kind", "object")
            ),
        )
        for goal in goals
        if goal["kind"] != "undisturbed"
    ]


def _distance(one: Mapping[str, float], other: Mapping[str, float], cfg: MemoryCfg) -> float:
    """Compute the largest difference, relative to its limit; infinite if a number is missing."""
    if set(one) != set(other):
        return math.inf
    worst = 0.0
    for key, a in one.items():
        b = other[key]
        if key.startswith("place."):
            worst = max(worst, abs(a - b) / cfg.place_m)
            continue
        factor = (
            cfg.size_factor
            if ".size." in key
            else cfg.mass_factor
            if key.endswith("mass_kg")
            else (cfg.friction_factor if key.endswith(".friction") else cfg.number_factor)
        )
        if a == b:
            continue
        if a <= 0 or b <= 0:
            return math.inf
        worst = max(worst, abs(math.log(a / b)) / math.log(factor))
    return worst
