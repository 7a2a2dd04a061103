"""The result of a run as an object: metrics, events, and tables of the trajectory, read from its folder."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from coral.advisor.registry import asks_person
from coral.errors import InputError
from coral.foreign_file import read_log_lines
from coral.plugins import our_part
from coral.run_files import RunFiles
from coral.runs import read_events, read_records

if TYPE_CHECKING:
    import pyarrow as pa
    from matplotlib.figure import Figure


class ResultFolder:
    """Folder of a run: the user's, or a temporary one that disappears with this object."""

    def __init__(self, out: str | Path | None) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="coral-") if out is None else None
        self.path = Path(out) if out is not None else Path(self._temporary.name)  # type: ignore[union-attr]


def demand_inbox(advisor: str, out: object) -> None:
    """Check that a person who is asked can find the questions: in a folder that the user knows.

    Raises:
        InputError: A person is asked, and the run folder would be a temporary one.
    """
    if out is None and asks_person(advisor):
        raise InputError("out", "", f"no folder for --advisor {advisor}", "one: its inbox/ holds the questions")


class RunResult:
    """What a finished run left."""

    def __init__(self, folder: ResultFolder, metrics: Mapping[str, Any]) -> None:
        self._folder = folder
        self.metrics: dict[str, Any] = dict(metrics)
        """Metrics and timing, by the names that `--json` uses."""

    @property
    def folder(self) -> Path:
        """Return the run folder; a temporary one disappears with the result."""
        return self._folder.path

    @property
    def end_reason(self) -> str:
        """Return why the run ended."""
        return str(self.metrics["end_reason"])

    @cached_property
    def events(self) -> list[dict[str, Any]]:
        """Read all events in order: `step`, `t` (s), `event`, and the fields of its kind."""
        return list(read_events(self.folder / RunFiles.EVENTS))

    @cached_property
    def attempts(self) -> list[dict[str, Any]]:
        """Read every question's attempts with their answers and verdicts; empty if nobody was asked."""
        path = self.folder / RunFiles.ATTEMPTS
        return list(read_records(path)) if path.exists() else []

    @property
    def trajectory(self) -> pa.Table:
        """Read the trajectory, one row per control step; `.to_pandas()` or `polars.from_arrow` convert it."""
        return read_table(self.folder / RunFiles.TRAJECTORY)

    def events_of(self, event: str) -> pa.Table:
        """Return the events of one kind as a table; nested fields are JSON text."""
        import pyarrow as pa

        rows = [
            {key: json.dumps(value) if isinstance(value, dict | list) else value for key, value in row.items()}
            for row in self.events
            if row["event"] == event
        ]
        names = dict.fromkeys(key for row in rows for key in row)
        return pa.table({name: column_of([row.get(name) for row in rows]) for name in names})

    def save(self, folder: str | Path) -> Path:
        """Copy the run folder to a new or empty one, and return it.

        Raises:
            InputError: The folder is not empty.
        """
        target = Path(folder)
        if target.exists() and (not target.is_dir() or any(target.iterdir())):
            raise InputError(str(target), "", "a file or a folder that is not empty", "a new or empty folder")
        shutil.copytree(self.folder, target, dirs_exist_ok=True)
        return target

    def plot(self) -> Figure:
        """Draw a mission's map and the shares seen over time, or a task's motion and force on the hand."""
        figure: Figure = our_part("plot", self._system, "plot")(self.folder)
        return figure

    def _repr_html_(self) -> str:
        page: str = our_part("plot", "page", "plot")(self.folder.name, self._summary(), self.plot())
        return page

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{key}={value!r}' for key, value in self._summary().items())})"

    def _summary(self) -> dict[str, Any]:
        return {key: self.metrics[key] for key in self._shown if key in self.metrics}

    _system = ""
    _shown: tuple[str, ...] = ("end_reason",)


def read_table(path: Path) -> pa.Table:
    """Read a trajectory file: whole numbers for `step`, floats for everything else, nothing for empty cells."""
    import pyarrow as pa
    from pyarrow import csv

    names = next(read_log_lines(path), "").strip().split(",")
    types = {name: pa.int64() if name == "step" else pa.float64() for name in names}
    options = csv.ConvertOptions(column_types=types, null_values=[""], strings_can_be_null=True)
    return csv.read_csv(path, convert_options=options)


def column_of(values: list[Any]) -> Any:
    """Make a column of a table; values of several types become text."""
    import pyarrow as pa

    try:
        return pa.array(values)
    except (pa.ArrowInvalid, pa.ArrowTypeError):
        return pa.array([None if value is None else str(value) for value in values])
