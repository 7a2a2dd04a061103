"""What the process of the costs may answer: a compromised one could send anything, so every answer is checked whole."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Whole = Annotated[int, Field(ge=0, le=2**53)]


class WorkerAnswer(BaseModel):
    """An answer; it holds what its kind holds and nothing else."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class WorkerFailure(WorkerAnswer):
    """A request that could not be answered.

    Args:
        error: Code, text, line, and the text of that line.
    """

    error: tuple[str, str, Whole, str]


class Ready(WorkerAnswer):
    """The process has started.

    Args:
        ready: Always true.
        filtered: Whether its system calls are filtered.
    """

    ready: bool
    filtered: bool


class Loaded(WorkerAnswer):
    """A program was loaded.

    Args:
        reads: Quantities that it may read.
        source: Its text as lines are counted.
        dropped: Numbers of programs that made place for it.
    """

    reads: list[str]
    source: str
    dropped: list[Whole]


class Ran(WorkerAnswer):
    """A program was evaluated; the values lie in the shared memory one after the other.

    Args:
        terms: Names of the terms.
    """

    terms: list[str] = Field(min_length=1)
