"""What stands in a world besides oysters: obstacles, tethered balls, walls and tanks, all made of simple solids."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import not_
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

TANK_SIDES = 48
"""Walls of a round tank. Their corners lie 0.2 % of the radius farther out than their middles."""

# Strict: neither "true" nor text is accepted as a number.
Metres = Annotated[float, Field(gt=0, le=1000, strict=True)]
Extent = Annotated[float, Field(ge=0.001, le=100, strict=True)]
Coordinate = Annotated[float, Field(ge=-1000, le=1000, strict=True)]
Angle = Annotated[float, Field(ge=-7, le=7, strict=True)]
Speed = Annotated[float, Field(ge=-1, le=1, strict=True)]


class WorldPart(BaseModel):
    """A part of a world file: every key must be known, every number finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True)


class Tether(WorldPart):
    """A line from a floating obstacle straight down to its anchor on the sea floor."""

    radius: Extent = 0.004
    """Radius of the line (m)."""
    anchor: tuple[Extent, Extent, Extent] = (0.06, 0.06, 0.04)
    """Half edges of the anchor (m)."""


class Wall(WorldPart):
    """A straight upright wall on the sea floor."""

    begin: tuple[Coordinate, Coordinate]
    end: tuple[Coordinate, Coordinate]
    """Ends of its middle line (m)."""
    height_m: Metres = 1.5
    """Its height."""
    thickness_m: Metres = 0.1
    """Its thickness."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Wall:
        if math.dist(self.begin, self.end) < 0.001:
            raise ValueError("a wall begins and ends at different places")
        return self


class Tank(WorldPart):
    """A round tank that stands on the sea floor; all that matters lies inside."""

    x: Coordinate
    y: Coordinate
    """Centre (m)."""
    radius_m: Metres
    """Inner radius."""
    height_m: Metres = 1.5
    """Height of its wall."""
    thickness_m: Metres = 0.1
    """Thickness of its wall."""


class Obstacle(WorldPart):
    """Something to keep clear of."""

    shape: Literal["sphere", "ellipsoid", "cylinder", "box"]
    """`sphere`, `ellipsoid`, `cylinder` (upright) or `box`."""
    x: Coordinate
    y: Coordinate
    z: Coordinate
    """Its middle."""
    size: tuple[Extent, Extent, Extent]
    """Half-extents along its own axes: (r, r, r), half-axes, (r, r, half height), half edges."""
    yaw: Angle = 0.0
    """Its heading."""
    tether: Tether | None = None
    """For a floating obstacle: its line and its anchor."""
    look: str | None = Field(default=None, exclude_if=not_)  # a file without it stays as it is
    """Of a part of a thing: its look in `kinds.yaml`."""
    thing: str | None = Field(default=None, exclude_if=not_)
    """The name of that thing."""

    @model_validator(mode="after")
    def _round_shapes_are_round(self) -> Obstacle:
        a, b, c = self.size
        if self.shape == "sphere" and not a == b == c:
            raise ValueError("a sphere has three equal half-extents")
        if self.shape == "cylinder" and a != b:
            raise ValueError("a cylinder has two equal radii: (r, r, half height)")
        return self


def structures(
    obstacles: Sequence[Obstacle], walls: Sequence[Wall], tank: Tank | None, floor: float
) -> tuple[Obstacle, ...]:
    """Return the tethers with their anchors, the walls and the sides of a tank as solids, in this order."""
    found: list[Obstacle] = []
    for ball in obstacles:
        if ball.tether is None:
            continue
        a, b, c = ball.tether.anchor
        radius, half = ball.tether.radius, 0.5 * (ball.z - ball.size[2] - floor)
        line = Obstacle(shape="cylinder", x=ball.x, y=ball.y, z=floor + half, size=(radius, radius, half))
        found += [line, Obstacle(shape="box", x=ball.x, y=ball.y, z=floor + c, size=(a, b, c), yaw=ball.yaw)]
    for wall in walls:
        found.append(_upright(wall.begin, wall.end, wall.thickness_m, wall.height_m, floor))
    if tank is not None:
        found += _round(tank, floor)
    return tuple(found)


def _upright(
    begin: tuple[float, float], end: tuple[float, float], thickness_m: float, height_m: float, floor: float
) -> Obstacle:
    """Return the box of a wall along a line."""
    (x0, y0), (x1, y1) = begin, end
    return Obstacle(
        shape="box",
        x=0.5 * (x0 + x1),
        y=0.5 * (y0 + y1),
        z=floor + 0.5 * height_m,
        size=(0.5 * math.dist(begin, end), 0.5 * thickness_m, 0.5 * height_m),
        yaw=math.atan2(y1 - y0, x1 - x0),
    )


def _round(tank: Tank, floor: float) -> list[Obstacle]:
    """Return the sides of a tank: the middles of their inner faces lie on its circle."""
    middle_m = tank.radius_m + 0.5 * tank.thickness_m
    corner_m = (tank.radius_m + tank.thickness_m) / math.cos(math.pi / TANK_SIDES)
    half_m = corner_m * math.sin(math.pi / TANK_SIDES)
    sides = []
    for k in range(TANK_SIDES):
        angle = 2.0 * math.pi * (k + 0.5) / TANK_SIDES
        c, s = math.cos(angle), math.sin(angle)
        x, y = tank.x + middle_m * c, tank.y + middle_m * s
        ends = (x + half_m * s, y - half_m * c), (x - half_m * s, y + half_m * c)
        sides.append(_upright(*ends, tank.thickness_m, tank.height_m, floor))
    return sides
