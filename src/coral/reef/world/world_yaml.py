"""World files as text: YAML, read with a limit on its size, written with one object per line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coral.errors import InputError
from coral.foreign_file import read_text
from coral.yaml_file import load_mapping, to_yaml

_LONG = ("spine", "things", "clusters", "alike", "lying", "obstacles")
"""Keys whose entries are written line by line, in this order at the end of the file."""
_RARE = ("walls",)
"""Keys that are left out where they hold nothing."""


def read_mapping(path: Path) -> dict[str, Any]:
    """Read the content of a world file, without checking it.

    Raises:
        InputError: The file is missing, is a folder, cannot be read, is too large, is not YAML or is no mapping.
    """
    text = read_text(path, "a readable world file (YAML)")
    keys = "a mapping with the keys name, size_m, start, clusters, ..."
    if not (content := load_mapping(text, str(path), expected=keys)):
        raise InputError(str(path), "", "an empty file", keys)
    return content


def to_text(world: Mapping[str, Any], header: Sequence[str] = ()) -> str:
    """Write a world's plain values as YAML: the header as a comment, then one line per oyster and per obstacle."""
    lines = [f"# {line}".rstrip() for line in header]
    lines += [
        f"{key}: {_flow(value)}" for key, value in world.items() if key not in _LONG and (value or key not in _RARE)
    ]
    for key in _LONG:
        if key not in world:
            continue
        lines.append(f"{key}:" if world[key] else f"{key}: []")
        for item in world[key]:
            if key in ("clusters", "alike", "lying"):
                lines += [f"  - name: {_flow(item['name'])}"]
                lines += [f"    kind: {item['kind']}"] if "kind" in item else []
                lines += ["    oysters:"]
                lines += [f"      - {_flow(oyster)}" for oyster in item["oysters"]]
            else:
                lines.append(f"  - {_flow(item)}")
    return "\n".join(lines) + "\n"


def _flow(value: Any) -> str:
    """Write a value in YAML flow style on one line, with floats rounded to a thousandth."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key}: {_inner(item)}' for key, item in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_inner, value))}]"
    if isinstance(value, float) and abs(value) < 1e9:  # PyYAML takes a hundred times as long
        return str(round(value, 3) + 0.0)  # never -0.0
    return to_yaml(value, default_flow_style=True, width=1_000_000).removesuffix("...\n").strip()


def _inner(value: Any) -> str:
    """Write a value between brackets, where a comma in a text needs quotes."""
    if isinstance(value, str):
        return to_yaml([value], default_flow_style=True, width=1_000_000).strip()[1:-1]
    return _flow(value)
