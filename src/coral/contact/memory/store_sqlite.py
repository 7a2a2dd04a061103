"""Experiences in one SQLite file, for one machine.

Each row is one transaction, with a fully synchronised write-ahead log: a process killed at any moment loses no
acknowledged write, and several processes may write.
"""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coral.errors import InputError
from coral.foreign_file import open_sqlite, refuse_computed

BUSY_S = 30.0
"""Longest wait for other writers."""
LONGEST_S = 30.0
"""Longest duration of one call; a trigger or view in a foreign file could ask for endless work."""
COLUMNS = {"id": int, "created": str, "record": str, "used": int, "helped": int}
TABLE = """CREATE TABLE IF NOT EXISTS experience (
    id INTEGER PRIMARY KEY AUTOINCREMENT, created TEXT NOT NULL, record TEXT NOT NULL, embedder TEXT NOT NULL,
    vector BLOB NOT NULL, used INTEGER NOT NULL DEFAULT 0, helped INTEGER NOT NULL DEFAULT 0)"""
"""Version 0.2 kept a vector of the instruction, too; its columns stay, empty, so that either version reads the file."""


@dataclass(frozen=True)
class Row:
    """One stored experience."""

    id: int
    """Number of the experience, from 1."""
    created: str
    """Time of storage, UTC."""
    record: str
    """The experience as JSON."""
    used: int = 0
    helped: int = 0
    """Number of uses, and number of uses that ended in success."""


class SqliteStore:
    """Keeps rows in a file, created at the first row.

    Several processes may write at once; an acknowledged write survives a kill. Every call raises `InputError`, which
    names the file, if it cannot be read or written.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.name = path, str(path)

    def exists(self) -> bool:
        """Return whether anything was ever written."""
        return self.path.is_file()

    def insert(self, created: str, record: str) -> int:
        """Write an unused row and return its number. The file is created if it does not exist."""
        with self._open(write=True) as base:
            row = base.execute(
                "INSERT INTO experience (created, record, embedder, vector) VALUES (?, ?, '', x'')", (created, record)
            )
            return int(row.lastrowid or 0)

    def rows(self) -> list[Row]:
        """Return all rows by their numbers; none if nothing was ever written."""
        if not self.path.exists():
            return []
        with self._open() as base:
            found = base.execute(f"SELECT {', '.join(COLUMNS)} FROM experience ORDER BY id").fetchall()
        return [self._row(values) for values in found]

    def _row(self, values: tuple[Any, ...]) -> Row:
        """Decode a row and check that its columns have the types that this package writes.

        Raises:
            InputError: A column has another type.
        """
        for (column, kind), value in zip(COLUMNS.items(), values, strict=True):
            if not isinstance(value, kind):
                shown = "nothing" if value is None else type(value).__name__
                raise InputError(self.name, f"experience {values[0]}.{column}", shown, f"{kind.__name__} in every row")
        return Row(*values)

    def delete(self, number: int) -> None:
        """Remove a row if it exists."""
        with self._open(write=True) as base:
            base.execute("DELETE FROM experience WHERE id = ?", (number,))

    def count(self, number: int, helped: bool) -> None:
        """Record that a row was used, if it still exists."""
        counted = "UPDATE experience SET used = used + 1, helped = helped + ? WHERE id = ?"
        with self._open(write=True) as base:
            base.execute(counted, (int(helped), number))

    @contextmanager
    def _open(self, write: bool = False) -> Iterator[sqlite3.Connection]:
        try:
            if write:
                self.path.parent.mkdir(parents=True, exist_ok=True)
            with open_sqlite(self.path, BUSY_S) as base:
                until = time.monotonic() + LONGEST_S
                base.set_progress_handler(lambda: time.monotonic() > until, 1_000_000)
                if write:
                    _enable_write_ahead(base)
                if write or not base.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                    base.execute(TABLE)  # not when reading another program's file
                refuse_computed(base, self.name, "experience")
                with base:
                    yield base
        except (sqlite3.Error, OSError) as error:
            raise InputError(self.name, "", error, "an SQLite file of experiences that can be opened") from None


def _enable_write_ahead(base: sqlite3.Connection) -> None:
    """Enable write-ahead logging with full synchronisation.

    SQLite does not wait for its lock when it changes the journal, but fails at once if another process writes to a new
    file at the same moment.

    Raises:
        sqlite3.OperationalError: The file stays locked.
    """
    until = time.monotonic() + BUSY_S
    while True:
        try:
            base.execute("PRAGMA journal_mode=WAL")
            base.execute("PRAGMA synchronous=FULL")
            return
        except sqlite3.OperationalError:
            if time.monotonic() > until:
                raise
            time.sleep(0.005)
