"""`coral memory list|show|forget`: the experience memory of contact tasks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from coral.contact.memory.memory import Stored, open_existing
from coral.flags import Argument

FILE = "memory.sqlite"


def _row(stored: Stored) -> dict[str, Any]:
    held = stored.experience
    return {
        "seed": None,
        **held.provenance,
        "id": stored.id,
        "created": stored.created,
        "task": held.task,
        "instruction": held.instruction,
        "stages": held.plan.names,
        "used": stored.used,
        "helped": stored.helped,
        "success_rate": None if not stored.used else round(stored.helped / stored.used, 3),
    }


def _rate_text(row: Mapping[str, Any]) -> str:
    return f"helped {row['helped']} of {row['used']}" if row["used"] else "not used yet"


@dataclass(frozen=True, kw_only=True)
class MemoryFlags:
    """The flags of all these commands."""

    file: str = FILE
    """The memory, an SQLite file."""
    json: bool = False
    """Print one JSON object."""


@dataclass(frozen=True, kw_only=True)
class MemoryList(MemoryFlags):
    """List the remembered experiences: origin, uses, and how many of these succeeded."""

    def __call__(self) -> Mapping[str, Any]:
        return {"file": self.file, "experiences": [_row(stored) for stored in open_existing(self.file).all()]}

    def describe(self, result: Mapping[str, Any]) -> str:
        rows = [
            f"{row['id']:>4}  {row['task']:<18} {row['world']!s:<6} seed {row['seed']!s:<5} "
            f"by {row.get('advisor')!s:<22} {_rate_text(row):<16}  {', '.join(row['stages'])}"
            for row in result["experiences"]
        ]
        return "\n".join(rows) or f"{result['file']}: nothing is remembered"


@dataclass(frozen=True, kw_only=True)
class MemoryOne(MemoryFlags):
    """The flags of the commands about one experience."""

    id: Annotated[int, Argument()]
    """Number of the experience, from `coral memory list`."""


@dataclass(frozen=True, kw_only=True)
class MemoryShow(MemoryOne):
    """Show one experience: task, numbers, programs, regions, provenance."""

    def __call__(self) -> Mapping[str, Any]:
        stored = open_existing(self.file).get(self.id)
        return {
            **_row(stored),
            "experience": stored.experience.model_dump(mode="json"),
            "programs": stored.experience.plan.text(),
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        head = [f"{key}: {value}" for key, value in result.items() if key not in ("experience", "programs")]
        return "\n".join([*head, "", result["programs"]])


@dataclass(frozen=True, kw_only=True)
class MemoryForget(MemoryOne):
    """Delete one experience."""

    def __call__(self) -> Mapping[str, Any]:
        open_existing(self.file).forget(self.id)
        return {"file": self.file, "forgotten": self.id}

    def describe(self, result: Mapping[str, Any]) -> str:
        return f"{result['file']}: {result['forgotten']} is forgotten"
