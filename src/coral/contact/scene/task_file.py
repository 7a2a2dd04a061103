"""Task files, shipped and custom, read with errors that name the field."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pydantic import (
    ValidationError,
)

from coral.config import read_yaml
from coral.contact.scene.shapes import Shape
from coral.contact.scene.task import Task
from coral.contact.scene.task_validation import check_task
from coral.errors import InputError, nearest
from coral.file_writer import write_whole
from coral.validation_errors import input_error

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


def load_task_file(name_or_path: str | Path) -> Task:
    """Load a shipped task by its name, one of the unseen suite included, or a task file.

    Raises:
        InputError: There is no such task, or the file is invalid; the error names the field.
    """
    shipped = shipped_tasks()
    text = str(name_or_path)
    unseen = _unseen()
    if text in shipped:
        path = TASKS_DIR / f"{text}.yaml"
    elif text in unseen:
        path = unseen[text]
    else:
        path = Path(name_or_path)
        if path.suffix not in (".yaml", ".yml") and not path.exists():
            close = nearest(text, (*shipped, *unseen))
            raise InputError("task", "", text, f"one of {', '.join(shipped)}{close}, or a YAML file")
    try:
        task = Task.model_validate(read_yaml(path))
    except ValidationError as error:
        raise input_error(str(path), error, Task) from None
    task = _resolve_mesh_paths(task, path.parent)
    check_task(task, str(path))
    return task


def _resolve_mesh_paths(task: Task, folder: Path) -> Task:
    """Make the paths of meshes absolute."""

    def placed(part: Shape) -> Shape:
        return part if part.file is None else part.model_copy(update={"file": str((folder / part.file).resolve())})

    objects = tuple(
        item.model_copy(update={"parts": tuple(placed(part) for part in item.parts)}) for item in task.objects
    )
    return task.model_copy(update={"objects": objects})


def task_schema() -> dict[str, Any]:
    """Return the JSON schema of a task file."""
    schema = Task.model_json_schema()
    schema["title"] = "CoRAL contact task"
    return schema


if __name__ == "__main__":
    write_whole(TASKS_DIR / "schema.json", json.dumps(task_schema(), indent=1) + "\n")
