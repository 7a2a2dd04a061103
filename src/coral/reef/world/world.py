"""A reef world is a file: seabed, oyster clusters, obstacles, start pose, current, seed.

Frames: world ENU, metres, z up, seabed at `seabed.z_m`; x in [0, size_m[0]], y in [0, size_m[1]].
Angles in radians, counter-clockwise, 0 along +x.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError

from coral.errors import InputError, nearest
from coral.file_writer import write_whole, writing
from coral.odd_text import encodable
from coral.reef.world.structures import (
    Angle,
    Coordinate,
    Extent,
    Metres,
    Obstacle,
    Speed,
    Tank,
    Wall,
    WorldPart,
    structures,
)
from coral.reef.world.world_check import check_world
from coral.reef.world.world_yaml import read_mapping, to_text
from coral.validation_errors import input_error, shown

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
    "world_schema",
]

WORLDS_DIR = Path(__file__).parent / "worlds"
FORMAT: Literal["coral-reef/1"] = "coral-reef/1"


class Seabed(WorldPart):
    """Flat sea floor."""

    z_m: Coordinate = 0.0


class Start(WorldPart):
    """Where the vehicle begins, heading `theta` (rad)."""

    x: Coordinate
    y: Coordinate
    theta: Angle = 0.0


class Current(WorldPart):
    """Steady ocean current: the water's velocity in the world frame (m/s)."""

    x_m_s: Speed = 0.0
    y_m_s: Speed = 0.0


class Oyster(WorldPart):
    """One oyster: an ellipsoid with half-axes `radii` (m), turned by roll, pitch, yaw (rad, z-y-x)."""

    x: Coordinate
    y: Coordinate
    z: Coordinate
    radii: tuple[Extent, Extent, Extent]
    rpy: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)


class Cluster(WorldPart):
    """Oysters that settled together; what coverage is counted in."""

    name: str = Field(min_length=1, max_length=40)
    oysters: tuple[Oyster, ...] = Field(min_length=1)


class ReefWorld(WorldPart):
    """A whole environment, as read from a YAML file."""

    format: Literal["coral-reef/1"] = FORMAT
    name: str = Field(min_length=1, max_length=60)
    topology: Literal["L", "S", "K", "E", "O", "branching", "looping", "patchy", "custom"] = "custom"
    size_m: tuple[Metres, Metres]
    seabed: Seabed = Seabed()
    start: Start
    current: Current = Current()
    clusters: tuple[Cluster, ...] = Field(min_length=1)
    obstacles: tuple[Obstacle, ...] = ()
    seed: int = Field(default=0, ge=0, lt=2**63, strict=True)
    water_depth_m: Metres | None = None
    """Depth of the water above the sea floor (m); null: not stated."""
    tank: Tank | None = None
    walls: tuple[Wall, ...] = ()
    spine: tuple[tuple[tuple[Coordinate, Coordinate], ...], ...] = ()
    """Polylines (m) that the reef was grown along; for drawings only, no decision reads them."""

    @property
    def solids(self) -> tuple[Obstacle, ...]:
        """Everything to keep clear of: the obstacles in the file's order, then tethers, anchors, walls and the tank."""
        return (*self.obstacles, *structures(self.obstacles, self.walls, self.tank, self.seabed.z_m))


def shipped_worlds() -> list[str]:
    """Return the names of the shipped reefs, topology by topology."""
    order = {letter: k for k, letter in enumerate("lskeo")}
    names = [path.stem for path in WORLDS_DIR.glob("*.yaml")]
    return sorted(names, key=lambda name: (order.get(name[0], 9), name))


def load_world(name: str | Path) -> ReefWorld:
    """Read a shipped reef by name, or a world file by path, and check it.

    Raises:
        InputError: There is no such world, or the file is broken, or no mission is possible in it.
    """
    text, known = str(name), shipped_worlds()
    path = WORLDS_DIR / f"{text}.yaml" if text in known else Path(text)
    if path.suffix not in (".yaml", ".yml", ".json") and not os.path.exists(path):
        raise InputError(
            "world", "", shown(text), f"a YAML file or one of {', '.join(known)}{nearest(text.lower(), known)}"
        )
    content = read_mapping(path)
    try:
        world = ReefWorld.model_validate(content)
    except ValidationError as error:
        raise input_error(str(path), error, ReefWorld) from None
    check_world(world, str(path))
    return world


def save_world(world: ReefWorld, path: Path, comment: str = "") -> None:
    """Write a world as YAML: one oyster or obstacle per line, rounded to millimetres and milliradians.

    Args:
        world: World to write.
        path: File to write. It is replaced as a whole, so no reader finds half a file.
        comment: Lines of the comment at the head of the file.

    Raises:
        InputError: The file cannot be written.
    """
    text = to_text(world.model_dump(mode="json", exclude_none=True), comment.splitlines())
    with writing(path):
        write_whole(path, encodable(text))


def world_schema() -> dict[str, Any]:
    """Return the JSON schema of a world file, for editors that complete and check as one types."""
    return ReefWorld.model_json_schema()
