"""A run as a folder: written during the run, readable at any moment, never overwriting anything."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import platform
import re
import subprocess
from collections.abc import Iterator, Mapping
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import IO, Any

from coral.errors import InputError, naming, without_password
from coral.file_writer import PRIVATE, open_log, write_whole, writing
from coral.foreign_file import parse_json, read_log_lines
from coral.odd_text import encodable, encodable_values
from coral.package_version import __version__
from coral.run_files import RunFiles
from coral.yaml_file import to_yaml


class RunWriter:
    """Opens a new run folder and appends to it; every line is flushed, so a killed run keeps its log."""

    def __init__(self, folder: Path, columns: tuple[str, ...]) -> None:
        """Create `folder`, which must not contain anything yet.

        Raises:
            InputError: The folder is not empty, or cannot be written.
        """
        self.folder = folder
        with writing(folder, "--out", "a folder that can be written"):
            folder.mkdir(PRIVATE, parents=True, exist_ok=True)
            require_empty(folder)
            self._events, self._rows = open_log(folder / RunFiles.EVENTS), open_log(folder / RunFiles.TRAJECTORY)
            self._rows.write(",".join(columns) + "\n")

    def event(self, step: int, t: float, event: str, **fields: Any) -> None:
        """Append one event."""
        line = {"step": step, "t": round(t, 6), "event": event, **fields}
        text = json.dumps(line, allow_nan=False, default=float)
        if "\\ud" in text:  # a letter beyond 16 bits, or half of one
            text = json.dumps(encodable_values(line), allow_nan=False, default=float)
        _append(self._events, without_password(text))

    def row(self, *values: float | int | str) -> None:
        """Append one row of the trajectory."""
        _append(self._rows, encodable(",".join(v if isinstance(v, str) else f"{v:.6g}" for v in values)))

    def yaml(self, name: str, content: Mapping[str, Any]) -> None:
        """Write a YAML file into the folder."""
        self.text(name, to_yaml(encodable_values(content)))

    def json(self, name: str, content: Mapping[str, Any]) -> None:
        """Write a JSON file into the folder."""
        self.text(name, json.dumps(encodable_values(content), indent=2, allow_nan=False, default=float) + "\n")

    def text(self, name: str, content: str) -> None:
        """Write a file atomically (temporary file, then rename)."""
        self.bytes(name, encodable(without_password(content)).encode())

    def bytes(self, name: str, content: bytes) -> None:
        """Write a binary file atomically."""
        write_whole(self.folder / name, content)

    def close(self) -> None:
        """Close the logs; writing a finished file after this is still allowed.

        An error of a full disk was reported at the time of writing.
        """
        for log in (self._events, self._rows):
            with contextlib.suppress(OSError):
                log.close()


def _append(log: IO[str], line: str) -> None:
    with naming(Path(log.name)):
        log.write(line + "\n")


def require_empty(folder: Path) -> None:
    """Refuse a run folder that contains anything.

    Raises:
        InputError: It does, or it cannot be read.
    """
    with writing(folder, "--out", "a folder that can be written"):
        if folder.exists() and any(folder.iterdir()):
            raise InputError(str(folder), "--out", "a folder that is not empty", "a new or empty folder")


def read_events(path: Path) -> Iterator[dict[str, Any]]:
    """Read the events of a run, in order; skip an incomplete last line of a killed run."""
    yield from (event for event in read_records(path) if isinstance(event.get("event"), str))


def read_records(path: Path) -> Iterator[dict[str, Any]]:
    """Read the JSON objects of a log, in order; skip an incomplete last line of a killed run."""
    for line in read_log_lines(path):
        try:
            record = parse_json(line)
        except ValueError:
            return
        if isinstance(record, dict):
            yield record


def read_rows(path: Path) -> Iterator[dict[str, str]]:
    """Read the complete rows of a trajectory, by column name."""
    yield from csv.DictReader(line for line in read_log_lines(path) if line.endswith("\n"))


def file_stem(name: str) -> str:
    """The name of a world or a task as part of a file's name: one that leads to no other folder."""
    return re.sub(r"[^\w.-]+", "-", name).strip("-.") or "unnamed"


def new_run_folder(root: Path, name: str) -> Path:
    """Return the first free folder among `root/name-001`, `root/name-002`, ..."""
    number = 1
    while (folder := root / f"{file_stem(name)}-{number:03d}").exists():
        number += 1
    return folder


def provenance() -> dict[str, Any]:
    """Return the origin of a result: version, commit, machine and date (kept out of metrics.json)."""
    return {
        "coral": __version__,
        "commit": _commit(),
        "python": platform.python_version(),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}",
        "date": datetime.now().astimezone().isoformat(timespec="seconds"),
    }


@cache
def _commit() -> str:
    here = Path(__file__).resolve().parent
    try:
        done = subprocess.run(
            ["git", "-C", str(here), "describe", "--always", "--dirty", "--abbrev=10"],
            capture_output=True,
            text=True,
            timeout=30,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return done.stdout.strip()
