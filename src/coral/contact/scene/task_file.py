"""Task files, shipped and custom, read with errors that name the field."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from coral.config import read_model
from coral.contact.scene.shapes import Shape
from coral.contact.scene.task import Task
from coral.contact.scene.task_names import TASKS_DIR, task_path
from coral.contact.scene.task_validation import check_task
from coral.file_writer import write_whole


def load_task_file(name_or_path: str | Path) -> Task:
    """Load a task of the package by its name, or a task file.

    Raises:
        InputError: There is no such task, or the file is invalid; the error names the field.
    """
    path = task_path(name_or_path)
    task = _resolve_mesh_paths(read_model(path, Task), path.parent)
    check_task(task, str(path))
    return task


def _resolve_mesh_paths(task: Task, folder: Path) -> Task:

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
