"""What a reef world consists of: seabed, oyster clusters, obstacles, start pose, current, seed.

Frames: world ENU, metres, z up, seabed at `seabed.z_m`; x in [0, size_m[0]], y in [0, size_m[1]].
Angles in radians, counter-clockwise, 0 along +x.
"""

from __future__ import annotations

from operator import not_
from typing import Any, Literal

from pydantic import Field, model_validator

from coral.reef.world.instruction import MissionText
from coral.reef.world.kinds import catalogue, find_kind, grow
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
    """Its height."""


class Start(WorldPart):
    """Where the vehicle begins."""

    x: Coordinate
    y: Coordinate
    """Its place."""
    theta: Angle = 0.0
    """Its heading, counter-clockwise from +x."""


class Current(WorldPart):
    """Steady ocean current."""

    x_m_s: Speed = 0.0
    y_m_s: Speed = 0.0
    """The water's velocity in the world frame (m/s), each within ±1."""


class Oyster(WorldPart):
    """One oyster, an ellipsoid."""

    x: Coordinate
    y: Coordinate
    z: Coordinate
    """Its middle."""
    radii: tuple[Extent, Extent, Extent]
    """Half-axes."""
    rpy: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)
    """Roll, pitch and yaw (z-y-x)."""
    shape: Literal["sphere", "ellipsoid", "cylinder", "box"] | None = Field(default=None, exclude_if=not_)
    """Of a part of a thing that is taken for an oyster; null: ellipsoid."""
    look: str | None = Field(default=None, exclude_if=not_)
    """Its look in `kinds.yaml`; null: an oyster's."""


class Cluster(WorldPart):
    """Oysters that settled together, the unit of coverage; or the solids of another thing."""

    name: str = Field(min_length=1, max_length=40)
    """At most 40 characters."""
    oysters: tuple[Oyster, ...] = Field(min_length=1)
    """At least one."""
    kind: str | None = Field(default=None, exclude_if=not_)
    """What it is in truth, where it is a thing of the world's list."""


class Thing(WorldPart):
    """Something of a kind of `kinds.yaml` that lies on the sea floor."""

    name: str = Field(min_length=1, max_length=40)
    """At most 40 characters."""
    kind: str = Field(max_length=40)
    """One of `kinds.yaml`."""
    x: Coordinate
    y: Coordinate
    """Its place."""
    yaw: Angle = 0.0
    """Its heading."""


def _part(solid: dict[str, Any]) -> dict[str, Any]:
    """Return a solid of a thing as an oyster of the file."""
    return {"radii" if key == "size" else key: value for key, value in solid.items()}


def _upright_part(solid: dict[str, Any], thing: str) -> dict[str, Any]:
    """Return a solid of a thing as an obstacle of the file."""
    return {**{key: value for key, value in solid.items() if key != "rpy"}, "yaw": solid["rpy"][2], "thing": thing}


class ReefWorld(WorldPart):
    """The file itself."""

    format: Literal["coral-reef/1"] = FORMAT
    """May be left out."""
    name: str = Field(min_length=1, max_length=60)
    """At most 60 characters."""
    topology: Literal["L", "S", "K", "E", "O", "branching", "looping", "patchy", "custom"] = "custom"
    """The layout that it was generated in."""
    size_m: tuple[Metres, Metres]
    """Extent: x and y begin at 0."""
    seabed: Seabed = Seabed()
    """The sea floor."""
    start: Start
    """Where the vehicle begins."""
    current: Current = Current()
    """Velocity of the water."""
    clusters: tuple[Cluster, ...]
    """The true oysters, those of things too. Empty only where there are things."""
    obstacles: tuple[Obstacle, ...] = ()
    """What to keep clear of."""
    seed: int = Field(default=0, ge=0, lt=2**63, strict=True)
    """The one that it was generated from."""
    water_depth_m: Metres | None = None
    """Depth of the water above the sea floor, for the depth sensor and the sonar; null: not stated."""
    tank: Tank | None = None
    """A round tank about the reef."""
    walls: tuple[Wall, ...] = ()
    """Upright walls."""
    spine: tuple[tuple[tuple[Coordinate, Coordinate], ...], ...] = ()
    """Polylines (m) that the reef was grown along; for drawings only, no decision reads them."""
    things: tuple[Thing, ...] = Field(default=(), max_length=200, exclude_if=not_)
    """What else lies there. Its oysters go to `clusters`, the rest by class to `alike`, `obstacles` or `lying`."""
    alike: tuple[Cluster, ...] = Field(default=(), exclude_if=not_)
    """Things that the robot's classes do not tell from oysters. They are no oysters, and are not counted as such."""
    lying: tuple[Cluster, ...] = Field(default=(), exclude_if=not_)
    """Things that the robot's classes do not tell from the sea floor."""

    mission: MissionText | None = Field(default=None, exclude_if=not_)
    """What is to be done, in words; null: survey the whole reef."""

    @model_validator(mode="before")
    @classmethod
    def _grow_things(cls, content: Any) -> Any:
        """Add the solids of the things that have none yet."""
        if not isinstance(content, dict) or not isinstance(things := content.get("things"), (list, tuple)):
            return content
        seabed = content.get("seabed")
        floor = seabed.get("z_m", 0.0) if isinstance(seabed, dict) else 0.0
        lists = {key: list(content.get(key) or ()) for key in ("clusters", "alike", "obstacles", "lying")}
        parts = [one for each in lists.values() for one in each if isinstance(one, dict)]
        grown = {one["name"] for one in parts if "kind" in one and "name" in one} | {one.get("thing") for one in parts}
        looks = catalogue().looks
        for thing in (Thing.model_validate(each) for each in things):
            if thing.name in grown:
                continue
            solids = grow(thing.kind, thing.x, thing.y, thing.yaw, float(floor))
            class_ = find_kind(thing.kind).class_
            if class_ == "obstacle":
                lists["obstacles"] += [_upright_part(solid, thing.name) for solid in solids]
            else:
                groups: dict[str, list[dict[str, Any]]] = {}
                for solid in solids:
                    key = "clusters" if looks[solid["look"]].oyster else "alike" if class_ == "oyster" else "lying"
                    groups.setdefault(key, []).append(_part(solid))
                for key, found in groups.items():
                    lists[key].append({"name": thing.name, "kind": thing.kind, "oysters": found})
        return {**content, **lists}

    @property
    def solids(self) -> tuple[Obstacle, ...]:
        """Everything to keep clear of: the obstacles in the file's order, then tethers, anchors, walls and the tank."""
        return (*self.obstacles, *structures(self.obstacles, self.walls, self.tank, self.seabed.z_m))
