"""Kinds of things on the sea floor (`kinds.yaml`): what a person calls them, the class that robots see, the look."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal
from zlib import crc32

import numpy as np
from pydantic import Field, ValidationError

from coral.errors import InputError, nearest
from coral.foreign_file import read_text
from coral.reef.world.structures import Coordinate, Extent, WorldPart
from coral.validation_errors import input_error
from coral.yaml_file import load_mapping

KINDS_FILE = Path(__file__).parent / "kinds.yaml"
Colour = tuple[float, float, float]
Shape = Literal["sphere", "ellipsoid", "cylinder", "box"]


class Look(WorldPart):
    """A surface of the painter, and its reflectances."""

    surface: Literal["shell", "rock", "pile", "block", "buoy", "card"]
    colours: tuple[Colour, ...] = Field(min_length=1)
    oyster: bool = False
    """Whether it is that of living oysters: what the truth of a reef counts."""


class Part(WorldPart):
    """Solids of one look: how many, how large, how placed. Metres and radians; see `kinds.yaml`."""

    look: str
    size: tuple[Extent, Extent, Extent]
    shape: Shape = "ellipsoid"
    count: Annotated[int, Field(ge=1, le=400)] = 1
    disc: float | None = None
    ring: float | None = None
    line: float | None = None
    across: float | None = None
    at: tuple[tuple[Coordinate, Coordinate, Coordinate], ...] = ()
    z: float = 0.0
    mound: float = 0.0
    lean: float = 0.0
    turn: float = 0.0
    vary: float = 0.0

    def places(self, rng: np.random.Generator) -> list[tuple[float, float, float, float]]:
        """Return x, y, z (m) and yaw (rad) of the solids about the middle of the thing."""
        if self.at:
            return [(*place, 0.0) for place in self.at]
        spread = np.linspace(-0.5, 0.5, self.count)
        if self.line is not None or self.across is not None:
            along, beside = self.line or 0.0, self.across or 0.0
            return [(float(s) * along, float(s) * beside, self.z, 0.0) for s in spread]
        if self.ring is not None:
            angles = np.arange(self.count) * (2.0 * math.pi / self.count)
            return [(self.ring * math.cos(a), self.ring * math.sin(a), self.z, a) for a in angles.tolist()]
        share, angle = np.sqrt(rng.random(self.count)), rng.uniform(-math.pi, math.pi, self.count)
        radius = (self.disc or 0.0) * share
        heights = self.z + self.mound * (1.0 - share**2)
        return list(
            zip(
                *((radius * f(angle)).tolist() for f in (np.cos, np.sin)), heights.tolist(), angle.tolist(), strict=True
            )
        )


class Kind(WorldPart):
    """One kind of thing."""

    says: str
    """What a person calls it."""
    class_: Literal["oyster", "obstacle", "floor"] = Field(alias="class")
    """What it is in the robot's class pictures."""
    parts: tuple[Part, ...] = Field(min_length=1)
    circles: float = 0.0
    """Rate (rad/s) at which an animal goes round its place, counter-clockwise; 0: it stays."""


class Catalogue(WorldPart):
    """All kinds and looks."""

    looks: dict[str, Look]
    kinds: dict[str, Kind]


@cache
def catalogue() -> Catalogue:
    """Return the kinds and looks that there are.

    Raises:
        InputError: `kinds.yaml` is broken.
    """
    where = str(KINDS_FILE)
    try:
        return Catalogue.model_validate(load_mapping(read_text(KINDS_FILE, where), where, expected="looks and kinds"))
    except ValidationError as error:
        raise input_error(where, error, Catalogue) from None


def find_kind(name: str) -> Kind:
    """Return a kind.

    Raises:
        InputError: There is none of this name.
    """
    kinds = catalogue().kinds
    if name not in kinds:
        raise InputError("kind", "", repr(name), f"one of {', '.join(kinds)}{nearest(name, list(kinds))}")
    return kinds[name]


def grow(kind: str, x: float, y: float, yaw: float, floor: float) -> list[dict[str, Any]]:
    """Return shape, x, y, z, size (half-extents), rpy and look of the solids of a thing, as a world file has them.

    They are the same for the same place, and no two places look the same.
    """
    rng = np.random.default_rng(crc32(f"{kind} {x:.3f} {y:.3f}".encode()))
    c, s = math.cos(yaw), math.sin(yaw)
    solids = []
    for part in find_kind(kind).parts:
        for px, py, pz, pyaw in part.places(rng):
            scale = 1.0 + part.vary * float(rng.uniform(-1.0, 1.0))
            roll, pitch = (float(part.lean * rng.uniform(-1.0, 1.0)) for _ in range(2))
            turned = yaw + pyaw + part.turn * float(rng.uniform(-1.0, 1.0))
            solids.append(
                {
                    "shape": part.shape,
                    "x": _mm(x + c * px - s * py),
                    "y": _mm(y + s * px + c * py),
                    "z": _mm(floor + pz),
                    "size": tuple(_mm(scale * half) for half in part.size),
                    "rpy": (_mm(roll), _mm(pitch), _mm(math.remainder(turned, 2.0 * math.pi))),
                    "look": part.look,
                }
            )
    return solids


def _mm(value: float) -> float:
    """Round to the precision of a world file: millimetres or milliradians."""
    return round(value, 3) + 0.0
