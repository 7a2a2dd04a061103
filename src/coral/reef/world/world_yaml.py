"""World files as text: YAML, read with a limit on its size, written with one object per line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from coral.errors import InputError
from coral.yaml_file import load_mapping, read_regular

MAX_VALUES = 500_000
"""Largest number of values in a file, YAML aliases expanded. A larger file is refused before anything iterates it."""


_LONG = ("spine", "clusters", "obstacles")
"""Keys whose entries are written line by line, in this order at the end of the file."""
_RARE = ("walls",)
"""Keys that are left out where they hold nothing."""
_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def read_mapping(path: Path) -> dict[str, Any]:
    """Read the content of a world file, without checking it.

    Raises:
        InputError: The file is missing, is a folder, cannot be read, is too large, is not YAML or is no mapping.
    """
    text = read_regular(path, "a readable world file (YAML)")
    keys = "a mapping with the keys name, size_m, start, clusters, ..."
    if not (content := load_mapping(text, str(path), MAX_VALUES, keys)):
        raise InputError(str(path), "", "an empty file", keys)
    return content


def to_text(world: Mapping[str, Any], header: Sequence[str] = ()) -> str:
    """Write a world as YAML text: a comment, then one line per oyster and per obstacle.

    Args:
        world: Plain values, as from `ReefWorld.model_dump(mode="json")`.
        header: Lines of the comment at the head.
    """
    lines = [f"# {line}".rstrip() for line in header]
    lines += [
        f"{key}: {_flow(value)}" for key, value in world.items() if key not in _LONG and (value or key not in _RARE)
    ]
    for key in _LONG:
        lines.append(f"{key}:" if world[key] else f"{key}: []")
        for item in world[key]:
            if key == "clusters":
                lines += [f"  - name: {_flow(item['name'])}", "    oysters:"]
                lines += [f"      - {_flow(oyster)}" for oyster in item["oysters"]]
            else:
                lines.append(f"  - {_flow(item)}")
    return "\n".join(lines) + "\n"


def _flow(value: Any) -> str:
    """Write a value in YAML flow style on one line, with floats rounded to a thousandth."""
    return (
        yaml.dump(
            _rounded(value),
            Dumper=_DUMPER,
            default_flow_style=True,
            sort_keys=False,
            allow_unicode=True,
            width=1_000_000,
        )
        .removesuffix("...\n")
        .strip()
    )


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 3) + 0.0  # never -0.0
    if isinstance(value, Mapping):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list | tuple) else value
