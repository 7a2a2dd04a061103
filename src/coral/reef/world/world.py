"""Reading and writing the file of a reef world."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from pydantic import ValidationError

from coral.file_writer import write_whole, writing
from coral.odd_text import encodable
from coral.reef.world.structures import Obstacle
from coral.reef.world.world_check import check_world
from coral.reef.world.world_model import Cluster, Current, Oyster, ReefWorld, Seabed, Start
from coral.reef.world.world_names import WORLDS_DIR, shipped_worlds, world_file
from coral.reef.world.world_yaml import read_mapping, to_text
from coral.validation_errors import input_error

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
