"""Tasks by name: a shipped one, one from a file, a scene of LIBERO, or a variation of one of these."""

from __future__ import annotations

from pathlib import Path

from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file
from coral.contact.scene.variation import split_variation, vary_task
from coral.plugins import has_plugin, named_plugin


def load_task(name_or_path: str | Path) -> Task:
    """Load a shipped task by name, one from a file, or a LIBERO scene (`libero:object/0`); with `~2`, its variation 2.

    Raises:
        InputError: There is no such task, or the file is invalid; the error names the field.
    """
    name, number = split_variation(str(name_or_path))
    kind, colon, _ = name.partition(":")
    loaded = bool(colon) and has_plugin("coral.tasks", kind)
    task = named_plugin("coral.tasks", kind, "task")(name) if loaded else load_task_file(name)
    return vary_task(task, number) if number else task
