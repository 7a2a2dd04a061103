"""Lines of a list that is gone through before a vehicle or an arm may move."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

Level = Literal["good", "lacking", "blocking"]
MARKS: Mapping[Level, str] = {"good": "  ", "lacking": "! ", "blocking": "X "}


@dataclass(frozen=True)
class CheckLine:
    """One line of the list."""

    subject: str
    text: str
    level: Level = "good"
    """lacking: it can do without. blocking: nothing moves."""

    def __str__(self) -> str:
        return list_text([self])


def blocking(lines: Iterable[CheckLine]) -> list[CheckLine]:
    """Return the lines that keep it from moving."""
    return [line for line in lines if line.level == "blocking"]


def level_of(wrong: bool) -> Level:
    """Return the level of a line that has to be in order."""
    return "blocking" if wrong else "good"


def list_text(lines: Iterable[CheckLine], marks: Mapping[Level, str] = MARKS) -> str:
    """Return the list for people, each line after the mark of its level."""
    return "\n".join(f"{marks[line.level]}{line.subject}: {line.text}" for line in lines)
