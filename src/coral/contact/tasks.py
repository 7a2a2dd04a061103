"""Tasks by name: a shipped one, one from a file, or a scene of LIBERO."""

from __future__ import annotations

from pathlib import Path

from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file
from coral.plugins import has_plugin, named_plugin


def load_task(name_or_path: str | Path) -> Task:
    """Load a shipped task by name, one from a file, or a LIBERO scene (`libero:object/0`).

    Raises:
        InputError: There is no such task, or the file is invalid; the error names the field.
    """
    name = str(name_or_path)
    kind, colon, _ = name.partition(":")
    loaded = bool(colon) and has_plugin("coral.tasks", kind)
    task: Task = named_plugin("coral.tasks", kind, "task")(name) if loaded else load_task_file(name)
    return task
