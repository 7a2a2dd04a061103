"""Reading a run folder, finished or interrupted at any moment."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.foreign_file import parse_json, read_picture_file, regular_bytes
from coral.limits import LARGEST_NUMBER, LOG_BYTES
from coral.odd_text import encodable_values
from coral.reef.world.geometry import Frame
from coral.run_files import RunFiles, SurveyFiles, TaskFiles
from coral.view.records import figures, is_extent, is_number, sound
from coral.words import many
from coral.yaml_file import load_mapping

Record = Mapping[str, Any]
_MARKS = (RunFiles.EVENTS, RunFiles.TRAJECTORY, RunFiles.CONFIG, RunFiles.METRICS)


@dataclass(frozen=True)
class RunFolder:
    """Contents of a run folder, as far as they were written."""

    path: Path
    events: tuple[Record, ...]
    trajectory: Mapping[str, NDArray[np.float64]]
    """Columns of trajectory.csv by name, Shape=(N,) each; an empty field is nan. All columns have one length."""
    attempts: tuple[Record, ...]
    metrics: Record
    timing: Record
    config: Record
    world: Record
    """The reef, or the task of a contact run."""
    frame_steps: tuple[int, ...]
    """Steps with a map in `frames/`, ascending."""
    notes: tuple[str, ...]
    """Notes on missing or unreadable data, one sentence each."""

    @property
    def complete(self) -> bool:
        """Return whether the run reached its own end: its metrics were written."""
        return bool(self.metrics)

    @property
    def duration_s(self) -> float:
        """Return the simulated time of the last record (s)."""
        times = self.column("t")
        last = [float(times[-1])] if len(times) else [0.0]
        return max(last + [float(event["t"]) for event in self.events[-1:]])

    @property
    def steps_per_s(self) -> float:
        """Return the rate of the steps, by which pictures are named."""
        steps, times = self.column("step"), self.column("t")
        return float(steps[-1] / times[-1]) if len(times) and steps[-1] > 0 and times[-1] > 0 else 10.0

    def column(self, name: str) -> NDArray[np.float64]:
        """Return a column of the trajectory, Shape=(N,); all nan if the file has no such column."""
        if name in self.trajectory:
            return self.trajectory[name]
        length = len(next(iter(self.trajectory.values()), np.zeros(0)))
        return np.full(length, np.nan)

    def select(self, *names: str) -> list[Record]:
        """Return the events of these kinds, in order."""
        return [event for event in self.events if event["event"] in names]

    def figures(self, compute: Callable[[Sequence[Record], Sequence[Mapping[str, str]]], Record]) -> Record:
        """Return the run's own metrics, or those computed from its record; empty if that is not possible."""
        if self.metrics:
            return self.metrics
        columns = [values.tolist() for values in self.trajectory.values()]
        rows = [dict(zip(self.trajectory, map(str, row), strict=True)) for row in zip(*columns, strict=True)]
        try:
            return compute(self.events, rows)
        except (KeyError, ValueError, TypeError):
            return {}

    @property
    def kept_pictures(self) -> bool:
        """Return whether the run kept pictures of its camera, not its final map alone."""
        return any((self.path / SurveyFiles.FRAMES).glob("*_labels.png"))

    def frame(self, step: int, kind: str) -> NDArray[Any] | None:
        """Read one picture of `frames/` as stored ("map", "depth", "labels" or "rgb"); None if unreadable.

        Shape=(H, W); of "rgb" Shape=(H, W, 3), in OpenCV's order of colours.
        """
        return read_frame(self.path, step, kind)

    def picture(self, digest: str) -> Path | None:
        """Find a picture of a question by its digest."""
        path = self.path / RunFiles.PICTURES / f"{digest}.png"
        return path if digest.isalnum() and path.is_file() else None

    @classmethod
    def read(cls, path: str | Path) -> RunFolder:
        """Read a run folder.

        A run may have been killed during a write: an incomplete last line is skipped, a missing file is empty, and
        `notes` reports it.

        Raises:
            InputError: There is no such folder, or it contains no run.
        """
        folder = Path(path)
        if not folder.is_dir():
            found = "a file" if folder.is_file() else "nothing"
            raise InputError(str(folder), "", found, "the folder of a run")
        if not any((folder / name).is_file() for name in _MARKS):
            raise InputError(str(folder), "", "no run in it", f"at least one of {', '.join(_MARKS)}")
        notes: list[str] = []
        task = (folder / TaskFiles.TASK).is_file()
        events = _lines(folder / RunFiles.EVENTS, notes)
        named = tuple(event for event in events if isinstance(event.get("event"), str) and is_number(event.get("t")))
        if len(named) < len(events):
            notes.append(f"events.jsonl: {len(events) - len(named)} lines have no name or time and were left out.")
        whole = _keep_sound(RunFiles.EVENTS, named, notes)
        attempts = folder / RunFiles.ATTEMPTS
        asked = not task or attempts.is_file()  # only a reef mission always asks an advisor
        numbers = (file.name[:-8] for file in (folder / SurveyFiles.FRAMES).glob("*_map.png"))
        return cls(
            path=folder,
            events=whole,
            trajectory=_table(folder / RunFiles.TRAJECTORY, notes),
            attempts=_keep_sound(RunFiles.ATTEMPTS, _lines(attempts, notes), notes) if asked else (),
            metrics=figures(_document(folder / RunFiles.METRICS, parse_json, notes)),
            timing=_document(folder / RunFiles.TIMING, parse_json, notes),
            config=_document(folder / RunFiles.CONFIG, _yaml, notes),
            world=_world(folder / (TaskFiles.TASK if task else SurveyFiles.WORLD), notes),
            frame_steps=tuple(sorted(int(number) for number in numbers if number.isdigit())),
            notes=tuple(notes),
        )


def read_frame(folder: Path, step: int, kind: str) -> NDArray[Any] | None:
    """Read one picture of a run folder; see `RunFolder.frame`."""
    path = folder / SurveyFiles.FRAMES / f"{step:06d}_{kind}.{'jpg' if kind == 'rgb' else 'png'}"
    return read_picture_file(path, channels=3 if kind == "rgb" else 1)


def read_camera_frame(folder: Path, step: int) -> Frame | None:
    """Read what the camera saw: depth and classes, and the colours if they were kept; None if unreadable."""
    labels, depth, rgb = (read_frame(folder, step, kind) for kind in ("labels", "depth", "rgb"))
    if labels is None or depth is None:
        return None
    metres = np.where(depth > 0, depth / 1000.0, np.inf).astype(np.float32)
    colours = None if rgb is None else np.ascontiguousarray(rgb[..., ::-1], np.uint8)
    return Frame(metres, np.minimum(labels, 3).astype(np.uint8), np.zeros(labels.shape, np.int32), colours)


def read_table(path: Path) -> dict[str, NDArray[np.float64]]:
    """Read the columns of a CSV file of numbers, as far as it was written; none if it is missing."""
    return _table(path, [])


def _yaml(text: str) -> Any:
    # A world may be written as JSON, which YAML's own parser reads a hundred times slower.
    if text.lstrip().startswith("{"):
        with suppress(ValueError):
            return parse_json(text)
    return load_mapping(text, "")


def _world(path: Path, notes: list[str]) -> Record:
    """Read the reef or the task; an invalid extent is left out."""
    world = _document(path, _yaml, notes)
    if "size_m" in world and not is_extent(world["size_m"]):
        notes.append(f"{path.name}: size_m is no width and height and was left out.")
        return {key: value for key, value in world.items() if key != "size_m"}
    return world


def _keep_sound(name: str, records: tuple[Record, ...], notes: list[str]) -> tuple[Record, ...]:
    kept = tuple(record for record in records if sound(record))
    if len(kept) < len(records):
        notes.append(f"{name}: {many(len(records) - len(kept), 'line')} with text where a number belongs left out.")
    return kept


def _text(path: Path, notes: list[str]) -> str:
    try:
        content = regular_bytes(path, LOG_BYTES)
        if len(content) > LOG_BYTES:
            notes.append(f"{path.name} is longer than {LOG_BYTES} bytes; the rest was left out.")
        return content[:LOG_BYTES].decode("utf-8", "replace")
    except FileNotFoundError:
        notes.append(f"{path.name} is missing.")
    except OSError as error:
        notes.append(f"{path.name} cannot be read: {error.strerror or error}.")
    return ""


def _lines(path: Path, notes: list[str]) -> tuple[Record, ...]:
    """Read the objects of a JSON-lines file; other lines are left out and noted."""
    records: list[Record] = []
    lines = _text(path, notes).splitlines()
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        record = parse_record(line)
        if record is not None:
            records.append(record)
        else:
            cut = "was cut off while it was written" if number == len(lines) else "is not a JSON object"
            notes.append(f"{path.name}: line {number} {cut} and was left out.")
    return tuple(records)


def _table(path: Path, notes: list[str]) -> dict[str, NDArray[np.float64]]:
    """Read the columns of a CSV file of numbers with a header line."""
    text = _text(path, notes)
    try:
        rows = list(csv.reader(io.StringIO(text)))
    except csv.Error as error:
        notes.append(f"{path.name} is no table and was left out: {error}.")
        return {}
    if not rows:
        return {}
    if not rows[0]:
        notes.append(f"{path.name} begins with an empty line instead of a header and was left out.")
        return {}
    header, body = rows[0], rows[1:]
    # Without a final newline the last number may lack digits, even if every field is there.
    if body and not text.endswith("\n"):
        body.pop()
        notes.append(f"{path.name}: the last line was cut off while it was written and was left out.")
    values = [numbers for row in body if (numbers := numbers_of(row, len(header))) is not None]
    if len(values) < len(body):
        notes.append(f"{path.name}: {len(body) - len(values)} lines are not {len(header)} numbers and were left out.")
    table = np.array(values, np.float64).reshape(-1, len(header))
    if "t" in header and not (timed := np.isfinite(table[:, header.index("t")])).all():
        notes.append(f"{path.name}: {many(int((~timed).sum()), 'line')} without a time left out.")
        table = table[timed]
    return {name: table[:, k].copy() for k, name in enumerate(header)}


def numbers_of(row: Sequence[str], count: int) -> list[float] | None:
    """Return the numbers of a row of a table; nan for nothing and for what no mission reaches; None if it is none."""
    if len(row) != count:
        return None
    words = {"": float("nan"), "true": 1.0, "false": 0.0}
    try:
        found = [words[field.lower()] if field.lower() in words else float(field) for field in row]
    except ValueError:
        return None
    return [number if abs(number) <= LARGEST_NUMBER else math.nan for number in found]


def _document(path: Path, parse: Callable[[str], Any], notes: list[str]) -> Record:
    """Read a JSON or YAML file with one mapping; empty if missing or truncated."""
    text = _text(path, notes)
    if not text:
        return {}
    document = parse_record(text, parse)
    if document is None:
        notes.append(f"{path.name} is incomplete and was left out.")
        return {}
    return document


def parse_record(text: str, parse: Callable[[str], Any] = parse_json) -> Record | None:
    """Return the mapping that a text is, with text that can be encoded; None if it is none."""
    try:
        record = parse(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(record, dict):
        return None
    return cast(Record, encodable_values(record) if "\\ud" in text.lower() else record)
