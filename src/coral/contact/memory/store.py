"""The interface of an experience store, and the choice of a store by a string."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from coral.contact.memory.embedding import Vector
from coral.contact.memory.row import Row
from coral.errors import InputError


class ExperienceStore(Protocol):
    """Keeps rows. Several processes may write at once; an acknowledged write survives a kill.

    Every call raises `InputError`, which names the store, if it cannot be read or written.
    """

    name: str
    """Location, as a user writes it."""

    def exists(self) -> bool:
        """Return whether anything was ever written."""
        ...

    def insert(self, created: str, record: str, embedder: str, vector: Vector) -> int:
        """Write an unused row and return its number. The store is created if it does not exist."""
        ...

    def rows(self) -> list[Row]:
        """Return all rows by their numbers; none if nothing was ever written."""
        ...

    def delete(self, number: int) -> None:
        """Remove a row if it exists."""
        ...

    def count(self, number: int, helped: bool) -> None:
        """Record that a row was used, if it still exists."""
        ...


def store_of(where: str | Path) -> ExperienceStore:
    """Return the store that a string selects.

    Args:
        where: `lance:` and a folder or URI for LanceDB; else the path of an SQLite file, as for any `Path`.

    Raises:
        InputError: There is no folder after `lance:`, or the package is not installed.
    """
    kind, colon, rest = ("", "", "") if isinstance(where, Path) else where.partition(":")
    if kind == "lance" and colon:
        from coral.contact.memory.store_lance import LanceStore

        if not rest:
            raise InputError(str(where), "", "no folder", "lance:FOLDER or lance:URI, such as lance:memory")
        return LanceStore(rest)
    from coral.contact.memory.store_sqlite import SqliteStore

    return SqliteStore(Path(where))
