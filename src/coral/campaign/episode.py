"""The interface of an episode to a campaign: a function of a spec and a folder that returns a record.

Results are compared where the version of the code and digests of other conditions are equal.
"""

from __future__ import annotations

import hashlib
import json
import os
import socket
import time
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Protocol

from coral.campaign.spec import Spec
from coral.errors import NO_ROOM
from coral.foreign_file import read_bytes
from coral.limits import YAML_BYTES

Episode = Callable[[Spec, Path], Mapping[str, Any]]
"""Runs one episode in a new folder and returns its record (JSON values). It must be picklable, and deterministic
except for times in the record."""

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
"""Environment of a worker: there is one worker per core, so one thread each."""
PACKAGE = Path(__file__).resolve().parents[1]
_SOURCES = {".py", ".yaml", ".json", ".md", ".xml"}
_ONLY_LOOKED_AT = {"campaign", "commands", "desk", "view"}
"""Parts of the package that only show or distribute results."""


@dataclass(frozen=True)
class EpisodeTask:
    """An episode to run and the folder to write into."""

    spec: Spec
    scratch: Path


@dataclass(frozen=True)
class EpisodeOutcome:
    """The outcome of a task: a result, or a message why there is none."""

    spec: Spec
    result: Mapping[str, Any] | None = None
    message: str = ""
    detail: str = ""
    no_room: bool = False
    """Whether the disk was full, which says nothing of the episode: it is to be run again."""
    about: Mapping[str, Any] = field(default_factory=dict)
    """Wall time (s), host, attempts and version of the code."""


def not_run(task: EpisodeTask, message: str, attempts: int, error: BaseException | str = "") -> EpisodeOutcome:
    """Return the outcome of a task that was never finished: lost, or refused by what should run it."""
    return EpisodeOutcome(task.spec, message=message, detail=str(error), about={"attempts": attempts})


class Executor(Protocol):
    """Runs episodes."""

    jobs: int
    """Number of simultaneous episodes, for the estimate of the remaining time."""

    def run(self, episode: Episode, tasks: Sequence[EpisodeTask]) -> Iterator[EpisodeOutcome]:
        """Run every task and yield each outcome once, as soon as it is available.

        The episode's files are in its task's scratch folder by then. A worker that dies affects no other episode: its
        own is repeated a few times, then its outcome is a failure. Closing the iterator early stops every worker.
        """


def perform(episode: Episode, spec: Spec, folder: Path) -> EpisodeOutcome:
    """Run one episode here; an exception, or a result that is not JSON, becomes a failure with its message."""
    started = time.perf_counter()
    about: dict[str, Any] = {"host": socket.gethostname(), "pid": os.getpid(), "code": code_version()}
    result: Mapping[str, Any] | None = None
    message = detail = ""
    no_room = False
    try:
        result = json.loads(json.dumps(dict(episode(spec, folder)), allow_nan=False, default=plain))
    except Exception as error:
        message, detail = f"{type(error).__name__}: {error}", traceback.format_exc()
        no_room = _is_of_full_disk(error)
    about["episode_wall_s"] = round(time.perf_counter() - started, 3)
    return EpisodeOutcome(spec, result, message, detail, no_room, about)


def _is_of_full_disk(error: BaseException | None) -> bool:
    """Check whether an error, or one that it was made of, says that the disk takes no more."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in NO_ROOM:
            return True
        error = error.__cause__ or error.__context__
    return False


def plain(value: Any) -> Any:
    """Convert a NumPy number to Python's own, and anything else that JSON lacks to text."""
    return value.item() if hasattr(value, "item") else str(value)


@cache
def code_version() -> str:
    """Compute a digest of every file of the package that can change the result of an episode.

    Unlike a commit it also distinguishes edited files, and is unaffected by changes of tables or pages.
    """
    total = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*")):
        inside = path.relative_to(PACKAGE)
        if path.suffix in _SOURCES and inside.parts[0] not in _ONLY_LOOKED_AT and path.is_file():
            total.update(f"{inside.as_posix()}\0".encode())
            total.update(hashlib.sha256(read_bytes(path, "a module", YAML_BYTES)).digest())
    return total.hexdigest()[:12]


def digest(content: Any) -> str:
    """Compute twelve hexadecimal digits that identify contents."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()[:12]
