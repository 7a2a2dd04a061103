"""Names of the shipped reefs, and the file that a name or a path means."""

from __future__ import annotations

import os
from pathlib import Path

from coral.errors import InputError, nearest, shown

WORLDS_DIR = Path(__file__).parent / "worlds"


def shipped_worlds() -> list[str]:
    """Return the names of the shipped reefs, topology by topology."""
    order = {letter: k for k, letter in enumerate("lskeo")}
    names = [path.stem for path in WORLDS_DIR.glob("*.yaml")]
    return sorted(names, key=lambda name: (order.get(name[0], 9), name))


def world_file(name: str | Path) -> Path:
    """Return the file of a shipped reef, or the path itself.

    Raises:
        InputError: It is neither a name nor the path of a file.
    """
    text, known = str(name), shipped_worlds()
    path = WORLDS_DIR / f"{text}.yaml" if text in known else Path(text)
    if path.suffix not in (".yaml", ".yml", ".json") and not os.path.exists(path):
        beside = [f"{text}.yaml"] if os.path.isfile(f"{text}.yaml") else []
        close = nearest(text, beside, 0.0) or nearest(text.lower(), known)
        expected = f"a YAML file or one of {', '.join(known)}{close}"
        raise InputError("world", "", shown(text), expected)
    return path
