"""Reading and writing the file of a reef world."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from coral.errors import InputError
from coral.file_writer import write_whole, writing
from coral.foreign_file import read_text
from coral.odd_text import encodable
from coral.reef.world.structures import Obstacle
from coral.reef.world.world_check import check_world
from coral.reef.world.world_model import Cluster, Current, Oyster, ReefWorld, Seabed, Start
from coral.reef.world.world_names import WORLDS_DIR, shipped_worlds, world_file
from coral.validation_errors import input_error
from coral.yaml_file import load_mapping, to_yaml

__all__ = [
    "Cluster",
    "Current",
    "Obstacle",
    "Oyster",
    "ReefWorld",
    "Seabed",
    "Start",
    "check_world",
    "load_world",
    "save_world",
    "shipped_worlds",
]
_LONG = ("spine", "things", "clusters", "alike", "lying", "obstacles")
"""Keys whose entries are written line by line, in this order at the end of the file."""
_RARE = ("walls",)
"""Keys that are left out where they hold nothing."""


def load_world(name: str | Path) -> ReefWorld:
    """Read a shipped reef by name, or a world file by path, and check it.

    Raises:
        InputError: There is no such world, or the file is broken, or no mission is possible in it.
    """
    path = world_file(name)
    if path.parent == WORLDS_DIR:
        return _shipped_world(path)
    return _read_world(path)


@cache
def _shipped_world(path: Path) -> ReefWorld:
    return _read_world(path)


def _read_world(path: Path) -> ReefWorld:
    content = read_mapping(path)
    try:
        world = ReefWorld.model_validate(content)
    except ValidationError as error:
        raise input_error(str(path), error, ReefWorld) from None
    check_world(world, str(path))
    return world


def save_world(world: ReefWorld, path: Path, comment: str = "") -> None:
    """Write a world as YAML: one oyster or obstacle per line, rounded to millimetres and milliradians.

    Raises:
        InputError: The file cannot be written.
    """
    text = to_text(world.model_dump(mode="json", exclude_none=True), comment.splitlines())
    with writing(path):
        write_whole(path, encodable(text))


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
