"""The records of a run as they are written: events and rows, from a folder that may still grow."""

from __future__ import annotations

import csv
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, Any

from coral.foreign_file import open_regular
from coral.run_files import RunFiles
from coral.view.records import sound
from coral.view.run import Record, numbers_of, parse_record

ROWS = 20_000
"""Rows of a recorded run that a page gets at most: more than its curves have pixels."""
Moment = dict[str, Any]


class Subject(ABC):
    """What a viewer is told of one kind of run; its methods `_on_EVENT` tell what an event changes."""

    head: dict[str, Any]
    """What never changes: title, scene, curves."""

    def tell(self, event: Record) -> Moment | None:
        """Return what an event changes for a viewer; None if nothing."""
        tell = getattr(self, f"_on_{event['event']}", None)
        told: Moment | None = tell(event) if tell is not None else None
        if told is not None:
            told["numbers"] = self._numbers()
        return told

    @abstractmethod
    def _numbers(self) -> list[list[str]]: ...

    @abstractmethod
    def row(self, row: Mapping[str, float]) -> list[float]:
        """Return the numbers that the page needs of one row of a trajectory, time first."""


class Tail:
    """The lines of a log that have been completed since the last look."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: IO[bytes] | None = None
        self._begun = b""

    def lines(self) -> list[str]:
        """Return the new lines."""
        if self._file is None:
            if not self._path.is_file():
                return []
            self._file = open_regular(self._path)
        *whole, self._begun = (self._begun + self._file.read()).split(b"\n")
        return [line.decode("utf-8", "replace") for line in whole]

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()


class RunStream:
    """What a viewer is told of a run folder so far, which may still be empty. Methods may be called from any thread.

    `subject` makes the subject once the run has written what it is about, and returns None as long as it has not.
    """

    def __init__(self, folder: Path, subject: Callable[[], Subject | None]) -> None:
        self.folder = folder
        self._make = subject
        self._subject: Subject | None = None
        self._lock = threading.Lock()
        self._events = Tail(folder / RunFiles.EVENTS)
        self._table = _Table(folder / RunFiles.TRAJECTORY)
        self._moments: list[Moment] = []

    @property
    def subject(self) -> Subject | None:
        """Return what the run is about, once that is known."""
        with self._lock:
            if self._subject is None:
                self._subject = self._make()
            return self._subject

    def news(self, moments: int, rows: int) -> dict[str, Any]:
        """Return what is new to a page that has so many moments and rows."""
        subject = self.subject
        if subject is None:
            return {"moments": [], "rows": [], "complete": False}
        with self._lock:
            for line in self._events.lines():
                event = _event(line)
                told = subject.tell(event) if event is not None else None
                if event is not None and told is not None:
                    self._moments.append({"t": event["t"], **told})
            self._table.update(subject.row)
            return {
                "moments": self._moments[moments:],
                "rows": self._table.rows[rows:],
                "steps_per_s": self._table.steps_per_s,
                "complete": (self.folder / RunFiles.METRICS).is_file(),
            }

    def close(self) -> None:
        """Close the files."""
        self._events.close()
        self._table.close()


class _Table(Tail):
    """The rows of the trajectory as the page gets them."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.rows: list[list[float | None]] = []
        self._header: list[str] = []
        self._seen = self._stride = 0
        self.steps_per_s = 10.0
        """Rate of the steps, by which pictures are named."""

    def update(self, row: Callable[[Mapping[str, float]], list[float]]) -> None:
        """Read what is new."""
        found = self.lines()
        if found and not self._header:
            self._header = next(csv.reader([found.pop(0)]), [])
        self._stride = self._stride or max(1, len(found) // ROWS)
        for k, line in enumerate(found):
            self._seen += 1
            if self._seen % self._stride and k < len(found) - 1:
                continue
            numbers = numbers_of(line.split(","), len(self._header))
            if numbers is not None:
                named = dict(zip(self._header, numbers, strict=True))
                self.steps_per_s = named["step"] / named["t"] if named.get("t", 0) > 0 and "step" in named else 10.0
                values = row(named)
                self.rows.append([float(f"{v:.5g}") if abs(v) < 1e9 else None for v in values])


def _event(line: str) -> Record | None:
    """Return an event that can be shown; None for a line that is none."""
    event = parse_record(line)
    if event is None or not isinstance(event.get("event"), str) or "t" not in event:
        return None
    return event if sound(event) else None
