"""Names of the shipped tasks and of the suites beside them, and the file that a name or a path means.

Departs from the paper: T2, `pick-box`, is read as a pick alone: the box is lifted and held. If the paper's table means
pick and place, `pick-clutter` is the only task here that places.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from coral.errors import InputError, nearest

TASKS_DIR = Path(__file__).parent / "tasks"
SUITES = ("unseen", "long", "force")
"""Suites of tasks beside the shipped ones, each a folder with two halves; `force` has no test half."""
HALVES = ("development", "test")


def shipped_tasks() -> tuple[str, ...]:
    """Return the names of the shipped tasks, in the order of the paper."""
    known = {path.stem for path in TASKS_DIR.glob("*.yaml")}
    order = ("push-pick-board", "pick-box", "pick-clutter", "push-force", "flip-box", "flip-wall")
    return tuple(name for name in order if name in known) + tuple(sorted(known - set(order)))


def suite_tasks(suite: str, half: str = "") -> tuple[str, ...]:
    """Return the names of one of `SUITES`, in alphabetical order, by default both halves.

    These are "development" and "test". The test half of `unseen` has been looked at since: it measures nothing unseen.

    Raises:
        InputError: There is no such half.
    """
    if half and half not in HALVES:
        raise InputError("task", "", half, f"one of {', '.join(HALVES)}{nearest(half, HALVES)}")
    return tuple(sorted(path.stem for one in ([half] if half else HALVES) for path in _files(suite, one)))


def _files(suite: str, half: str) -> Iterator[Path]:
    return (TASKS_DIR / suite / half).glob("*.yaml")


def every_task() -> tuple[str, ...]:
    """Return the names of all tasks of the package: the shipped ones, then those of each suite."""
    return (*shipped_tasks(), *(name for suite in SUITES for name in suite_tasks(suite)))


def task_path(name_or_path: str | Path) -> Path:
    """Return the file of a task of the package, or the path itself.

    Raises:
        InputError: It is neither a name nor the path of a file.
    """
    text, shipped = str(name_or_path), shipped_tasks()
    if text in shipped:
        return TASKS_DIR / f"{text}.yaml"
    suites = {path.stem: path for suite in SUITES for half in HALVES for path in _files(suite, half)}
    path = suites.get(text, Path(name_or_path))
    if path.suffix not in (".yaml", ".yml") and not path.exists():
        beside = [f"{text}.yaml"] if Path(f"{text}.yaml").is_file() else []
        close = nearest(text, beside, 0.0) or nearest(text, (*shipped, *suites))
        raise InputError("task", "", repr(text), f"one of {', '.join(shipped)}{close}, or a YAML file")
    return path
