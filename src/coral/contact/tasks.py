"""Tasks by name: a shipped one, one from a file, or a scene of LIBERO."""

from __future__ import annotations

from pathlib import Path

from coral.contact.libero.task import PREFIX, load_libero
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import load_task_file


def load_task(name_or_path: str | Path) -> Task:
    """Load a shipped task by name, one from a file, or a LIBERO scene (`libero:object/0`).

    Raises:
        InputError: There is no such task, or the file is invalid; the error names the field.
    """
    text = str(name_or_path)
    return load_libero(text) if text.startswith(PREFIX) else load_task_file(name_or_path)
