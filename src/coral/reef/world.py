"""A reef world is a file: seabed, oyster clusters, obstacles, start pose, current, seed.

Frames: world ENU, metres, z up, seabed at `seabed.z_m`; x in [0, size_m[0]], y in [0, size_m[1]].
Angles in radians, counter-clockwise, 0 along +x.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from coral.errors import InputError, nearest
from coral.odd_text import encodable
from coral.reef.world_check import check_world
from coral.reef.world_yaml import read_mapping, to_text
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

# Strict: neither "true" nor text is accepted as a number.
Metres = Annotated[float, Field(gt=0, le=1000, strict=True)]
Extent = Annotated[float, Field(ge=0.001, le=100, strict=True)]
Coordinate = Annotated[float, Field(ge=-1000, le=1000, strict=True)]
Angle = Annotated[float, Field(ge=-7, le=7, strict=True)]
Speed = Annotated[float, Field(ge=-1, le=1, strict=True)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Seabed(_Part):
    """Flat sea floor."""

    z_m: Coordinate = 0.0


class Start(_Part):
    """Where the vehicle begins, heading `theta` (rad)."""

    x: Coordinate
    y: Coordinate
    theta: Angle = 0.0


class Current(_Part):
    """Steady ocean current: the water's velocity in the world frame (m/s)."""

    x_m_s: Speed = 0.0
    y_m_s: Speed = 0.0


class Oyster(_Part):
    """One oyster: an ellipsoid with half-axes `radii` (m), turned by roll, pitch, yaw (rad, z-y-x)."""

    x: Coordinate
    y: Coordinate
    z: Coordinate
    radii: tuple[Extent, Extent, Extent]
    rpy: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)


class Cluster(_Part):
    """Oysters that settled together; what coverage is counted in."""

    name: str = Field(min_length=1, max_length=40)
    oysters: tuple[Oyster, ...] = Field(min_length=1)


class Obstacle(_Part):
    """Something to keep clear of. `size`: half-extents (m) along its own axes.

    sphere: (r, r, r); ellipsoid: half-axes; cylinder (upright): (r, r, half height); box: half edges.
    """

    shape: Literal["sphere", "ellipsoid", "cylinder", "box"]
    x: Coordinate
    y: Coordinate
    z: Coordinate
    size: tuple[Extent, Extent, Extent]
    yaw: Angle = 0.0

    @model_validator(mode="after")
    def _round_shapes_are_round(self) -> Obstacle:
        a, b, c = self.size
        if self.shape == "sphere" and not a == b == c:
            raise ValueError("a sphere has three equal half-extents")
        if self.shape == "cylinder" and a != b:
            raise ValueError("a cylinder has two equal radii: (r, r, half height)")
        return self


class ReefWorld(_Part):
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
    spine: tuple[tuple[tuple[Coordinate, Coordinate], ...], ...] = ()
    """Polylines (m) that the reef was grown along; for drawings only, no decision reads them."""


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
    text = to_text(world.model_dump(mode="json"), comment.splitlines())
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(encodable(text), encoding="utf-8")
        os.replace(part, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink()
        raise InputError(str(path), "", (error.strerror or "an error").lower(), "a file that can be written") from None


def world_schema() -> dict[str, Any]:
    """Return the JSON schema of a world file, for editors that complete and check as one types."""
    return ReefWorld.model_json_schema()
