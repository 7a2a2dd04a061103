"""What a reef world consists of: seabed, oyster clusters, obstacles, start pose, current, seed.

Frames: world ENU, metres, z up, seabed at `seabed.z_m`; x in [0, size_m[0]], y in [0, size_m[1]].
Angles in radians, counter-clockwise, 0 along +x.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

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
