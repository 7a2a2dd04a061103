"""Names of the shipped tasks and of the unseen suite, and the file that a name or a path means."""

from __future__ import annotations

from pathlib import Path

from coral.errors import InputError, nearest

TASKS_DIR = Path(__file__).parent / "tasks"
UNSEEN_HALVES = ("development", "test")


def shipped_tasks() -> tuple[str, ...]:
    """Return the names of the shipped tasks, in the order of the paper."""
    known = {path.stem for path in TASKS_DIR.glob("*.yaml")}
    order = ("push-pick-board", "pick-box", "pick-clutter", "push-force", "flip-box", "flip-wall")
    return tuple(name for name in order if name in known) + tuple(sorted(known - set(order)))


def unseen_tasks(half: str = "") -> tuple[str, ...]:
    """Return the names of the unseen suite, in alphabetical order.

    Args:
        half: "development", to be looked at while the method is built, or "test", kept for its measurement; both by
            default.

    Raises:
        InputError: There is no such half.
    """
    if half and half not in UNSEEN_HALVES:
        raise InputError("task", "", half, f"one of {', '.join(UNSEEN_HALVES)}{nearest(half, UNSEEN_HALVES)}")
    return tuple(sorted(name for name, path in _unseen().items() if half in ("", path.parent.name)))


def _unseen() -> dict[str, Path]:
    return {path.stem: path for half in UNSEEN_HALVES for path in (TASKS_DIR / "unseen" / half).glob("*.yaml")}


def task_path(name_or_path: str | Path) -> Path:
    """Return the file of a shipped task, one of the unseen suite included, or the path itself.

    Raises:
        InputError: It is neither a name nor the path of a file.
    """
    text, shipped, unseen = str(name_or_path), shipped_tasks(), _unseen()
    if text in shipped:
        return TASKS_DIR / f"{text}.yaml"
    path = unseen.get(text, Path(name_or_path))
    if path.suffix not in (".yaml", ".yml") and not path.exists():
        beside = [f"{text}.yaml"] if Path(f"{text}.yaml").is_file() else []
        close = nearest(text, beside, 0.0) or nearest(text, (*shipped, *unseen))
        raise InputError("task", "", repr(text), f"one of {', '.join(shipped)}{close}, or a YAML file")
    return path
