"""A reef world is a file: seabed, oyster clusters, obstacles, start pose, current, seed.

Frames: world ENU, metres, z up, seabed at `seabed.z_m`; x in [0, size_m[0]], y in [0, size_m[1]].
Angles in radians, counter-clockwise, 0 along +x.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from coral.errors import InputError, nearest

WORLDS_DIR = Path(__file__).parent / "worlds"
FORMAT = "coral-reef/1"

Metres = Annotated[float, Field(gt=0, le=1000)]
Coordinate = Annotated[float, Field(ge=-1000, le=1000)]
Angle = Annotated[float, Field(ge=-7, le=7)]


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

    x_m_s: float = Field(default=0.0, ge=-1, le=1)
    y_m_s: float = Field(default=0.0, ge=-1, le=1)


class Oyster(_Part):
    """One oyster: an ellipsoid with half-axes `radii` (m), turned by roll, pitch, yaw (rad, z-y-x)."""

    x: Coordinate
    y: Coordinate
    z: Coordinate
    radii: tuple[Metres, Metres, Metres]
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
    size: tuple[Metres, Metres, Metres]
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
    topology: Literal["L", "S", "K", "E", "O", "custom"] = "custom"
    size_m: tuple[Metres, Metres]
    seabed: Seabed = Seabed()
    start: Start
    current: Current = Current()
    clusters: tuple[Cluster, ...] = Field(min_length=1)
    obstacles: tuple[Obstacle, ...] = ()
    seed: int = Field(default=0, ge=0)
    spine: tuple[tuple[tuple[float, float], ...], ...] = ()
    """Polylines (m) that the reef was grown along; for drawings only, no decision reads them."""
