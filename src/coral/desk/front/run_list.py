"""The recorded runs of a folder, and what a front page says of each: a few numbers, read from two small files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coral.config import read_yaml
from coral.errors import InputError
from coral.foreign_file import read_json
from coral.run_files import RunFiles

MOST_RUNS = 200
"""Runs that the page lists, the latest first."""
ABOUT = ("system", "world", "task", "variant", "preset", "advisor", "seed")
NUMBERS: Mapping[str, Mapping[str, tuple[str, str]]] = {
    "reef": {
        "coverage": ("covered", "%"),
        "inspected": ("inspected", "%"),
        "collisions": ("collisions", ""),
        "sim_time_s": ("simulated time", "s"),
        "distance_m": ("distance", "m"),
        "advisor_calls": ("questions", ""),
        "rejections": ("answers refused", ""),
    },
    "contact": {
        "success": ("success", ""),
        "sim_time_s": ("simulated time", "s"),
        "time_with_thinking_s": ("with thinking", "s"),
        "repairs": ("repairs", ""),
        "path_length_m": ("path of the hand", "m"),
        "peak_hand_force_n": ("largest force", "N"),
        "advisor_calls": ("questions", ""),
    },
}
"""By system: the metric, and its name and unit on the page."""


def run_folders(root: Path) -> list[Path]:
    """Find the run folders below a folder, at most two floors down, the latest first."""
    found = [path.parent for pattern in ("*", "*/*") for path in root.glob(f"{pattern}/config.yaml")]
    found = [path for path in found if not path.is_symlink()]
    return sorted(found, key=lambda path: (path / RunFiles.CONFIG).stat().st_mtime, reverse=True)[:MOST_RUNS]


def run_card(folder: Path, root: Path) -> dict[str, Any]:
    """Describe a run: `name`, what it was of, `ended` ("" while it runs or if it was killed), and its `numbers`."""
    config, metrics = _mapping(folder / RunFiles.CONFIG), _mapping(folder / RunFiles.METRICS)
    system = "contact" if config.get("system") == "contact" else "reef"
    numbers = [
        {"name": name, "unit": unit, "value": _value(metrics[key], unit)}
        for key, (name, unit) in NUMBERS[system].items()
        if isinstance(metrics.get(key), bool | int | float)
    ]
    return {
        "name": folder.relative_to(root).as_posix(),
        **{key: str(config[key]) for key in ABOUT if isinstance(config.get(key), str | int)},
        "ended": str(metrics.get("end_reason", "")),
        "report": (folder / RunFiles.REPORT).is_file(),
        "numbers": numbers,
    }


def _value(value: float, unit: str) -> float | bool:
    if isinstance(value, bool):
        return value
    return round(100 * value if unit == "%" else value, 2)


def _mapping(path: Path) -> Mapping[str, Any]:
    """Read a file of a run; nothing where it is missing or broken, as in a run that was killed."""
    try:
        content = read_json(path, "a file of a run") if path.suffix == ".json" else read_yaml(path)
    except InputError:
        return {}
    return content if isinstance(content, Mapping) else {}
