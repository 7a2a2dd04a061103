"""Geometry of a task file: rigid pieces, movable objects, fixtures, the table.

Frames: world, metres, z up, the table's top at z = 0, x away from the robot. Lengths are full extents. Angles in files
are degrees. A range `[low, high]` is sampled in each trial; a single number is a range of one value.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    model_validator,
)


def in_order(value: tuple[float, float]) -> tuple[float, float]:
    """Return the range; raise ValueError if its lower end is above the upper one."""
    if value[0] > value[1]:
        raise ValueError("a range, its lower end first")
    return value


def _as_range(value: Any) -> Any:
    if isinstance(value, str | bool | dict):
        raise ValueError("a number, or a range [low, high]")
    return (value, value) if isinstance(value, int | float) else value


# Strict: neither "true" nor text passes for a number.
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,30}$")]
Number = Annotated[float, Field(ge=-1e6, le=1e6, strict=True)]
Metres = Annotated[float, Field(ge=0.001, le=10, strict=True)]
Coordinate = Annotated[float, Field(ge=-10, le=10, strict=True)]
Degrees = Annotated[float, Field(ge=-360, le=360, strict=True)]
Mass = Annotated[float, Field(ge=0.005, le=20, strict=True)]
Friction = Annotated[float, Field(ge=0.02, le=2, strict=True)]
Factor = Annotated[float, Field(ge=0.2, le=5, strict=True)]
Shade = Annotated[float, Field(ge=0, le=1, strict=True)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Extents = tuple[Metres, Metres, Metres]
Turn = tuple[Degrees, Degrees, Degrees]
Color = tuple[Shade, Shade, Shade]
PositionRange = Annotated[tuple[Coordinate, Coordinate], BeforeValidator(_as_range), AfterValidator(in_order)]
JointRange = Annotated[tuple[Degrees, Degrees], BeforeValidator(_as_range), AfterValidator(in_order)]
AngleRange = Annotated[tuple[Degrees, Degrees], BeforeValidator(_as_range), AfterValidator(in_order)]
MassRange = Annotated[tuple[Mass, Mass], BeforeValidator(_as_range), AfterValidator(in_order)]
FrictionRange = Annotated[tuple[Friction, Friction], BeforeValidator(_as_range), AfterValidator(in_order)]
ScaleRange = Annotated[tuple[Factor, Factor], BeforeValidator(_as_range), AfterValidator(in_order)]


class TaskPart(BaseModel):
    """A part of a task file: unknown keys, NaN and infinities are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Shape(TaskPart):
    """One rigid piece of an object, at `position` and turned by `rpy_deg` (z-y-x) in the object's frame.

    `size`: box, full edges (x, y, z); cylinder, (diameter, diameter, length) along z; sphere, three times the diameter;
    mesh, the factors on `file` (STL or OBJ; its path relative to the task file, once loaded absolute). What touches is
    the hull of a mesh. `color`, if it has its own, is red, green and blue from 0 to 1.
    """

    shape: Literal["box", "cylinder", "sphere", "mesh"] = "box"
    size: Extents
    position: Vector = (0.0, 0.0, 0.0)
    rpy_deg: Turn = (0.0, 0.0, 0.0)
    file: str | None = Field(default=None, pattern=r"^[^\x00]+$")
    color: Color | None = None

    @model_validator(mode="after")
    def _round(self) -> Shape:
        if (self.shape == "mesh") != (self.file is not None):
            raise ValueError("a mesh with its file, or another shape without one")
        if self.shape in ("cylinder", "sphere") and self.size[0] != self.size[1]:
            raise ValueError(f"a {self.shape} whose first two sizes are equal")
        if self.shape == "sphere" and self.size[0] != self.size[2]:
            raise ValueError("a sphere whose three sizes are equal")
        return self


class Joint(TaskPart):
    """What holds an object: a hinge (door, lid) or a slide (drawer), fixed to the world.

    Args:
        kind: Hinge or slide.
        axis: Its direction in the object's frame.
        point: A point on a hinge's axis, in the object's frame.
        range: Its ends, in degrees or metres, measured from how the file places the object.
        start: Where it stands at first, sampled in each trial.
        friction: Its friction, N m or N.
    """

    kind: Literal["hinge", "slide"]
    axis: Vector
    point: Vector = (0.0, 0.0, 0.0)
    range: JointRange
    start: JointRange = (0.0, 0.0)
    friction: float = Field(default=0.02, ge=0, le=50, strict=True)

    @model_validator(mode="after")
    def _possible(self) -> Joint:
        most = 170.0 if self.kind == "hinge" else 1.0
        if not any(self.axis):
            raise ValueError("an axis, not all zero")
        if self.kind == "slide" and any(self.point):
            raise ValueError("a point only with a hinge")
        if not -most <= self.range[0] < self.range[1] <= most:
            raise ValueError(f"a range within -{most:g} to {most:g}, not empty")
        if not self.range[0] <= self.start[0] <= self.start[1] <= self.range[1]:
            raise ValueError("a start within the range")
        return self


class Movable(TaskPart):
    """An object that moves.

    Args:
        parts: What it is made of; the object's frame is its own.
        mass_kg, friction: Drawn anew in each trial; unknown to the planner.
        scale: Factors on the three axes of all parts and points, drawn anew; the planner knows the result (known
            meshes).
        x, y: Where its frame's origin stands; z follows from resting on the table, or is `z`. With `stands_on`, x and
            y are those from the origin of that object, on whose top it stands.
        yaw_deg: Its heading; `rpy_deg` turns it before that, as to lay it on a side.
        points: Named points on it, in its frame.
        symmetry: Which turns leave it looking the same.
        joint: What holds it; it then passes through fixed things, and its range keeps it from them.
    """

    name: Name
    label: str = Field(default="", max_length=60)
    parts: tuple[Shape, ...] = Field(min_length=1, max_length=12)
    mass_kg: MassRange
    friction: FrictionRange
    scale: tuple[ScaleRange, ScaleRange, ScaleRange] = ((1.0, 1.0), (1.0, 1.0), (1.0, 1.0))
    x: PositionRange
    y: PositionRange
    z: Coordinate | None = None
    stands_on: Name | None = None
    yaw_deg: AngleRange = (0.0, 0.0)
    rpy_deg: Turn = (0.0, 0.0, 0.0)
    points: dict[Name, Vector] = Field(default_factory=dict)
    symmetry: Literal["none", "box", "square-box", "cube", "cylinder", "sphere"] = "none"
    joint: Joint | None = None
    color: Color = (0.76, 0.6, 0.42)

    @model_validator(mode="after")
    def _placed_once(self) -> Movable:
        if self.z is not None and self.stands_on is not None:
            raise ValueError("z or stands_on, not both")
        if self.joint is not None and any(axis != (1.0, 1.0) for axis in self.scale):
            raise ValueError("a scale of 1 for an object on a joint")
        return self


class Fixture(TaskPart):
    """A box that does not move, as a wall or the side of a bin."""

    name: Name
    size: Extents
    position: Vector
    yaw_deg: Degrees = 0.0
    friction: Friction = 0.6
    color: Color = (0.55, 0.58, 0.62)


class TableMark(TaskPart):
    """A coloured rectangle, `size` along x and y, on the table under a place: seen in pictures, felt by nothing."""

    place: Name
    size: tuple[Metres, Metres] = (0.06, 0.06)
    color: Color


class TableTop(TaskPart):
    """The table: its top face lies at z = 0."""

    size: Extents = (0.8, 0.8, 0.05)
    center: tuple[Coordinate, Coordinate] = (0.0, 0.0)
