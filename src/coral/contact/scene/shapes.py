"""Geometry of a task file: rigid pieces, movable objects, fixtures, the table.

Frames: world, metres, z up, the table's top at z = 0, x away from the robot. Lengths are full extents. Angles in files
are degrees. A range `[low, high]` is sampled in each trial; a single number is a range of one value.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator


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

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True)


class Shape(TaskPart):
    """One rigid part of an object."""

    shape: Literal["box", "cylinder", "sphere", "mesh"] = "box"
    """`box`, `cylinder` (along z), `sphere` or `mesh`. What touches is the hull of a mesh: build a hollow object from
    several parts."""
    size: Extents
    """Of a box its edges; of a cylinder the diameter twice, then its length; of a sphere the diameter three times; of a
    mesh the factors on its file."""
    position: Vector = (0.0, 0.0, 0.0)
    """Its middle in the object's frame."""
    rpy_deg: Turn = (0.0, 0.0, 0.0)
    """How it is turned there (z-y-x)."""
    file: str | None = Field(default=None, pattern=r"^[^\x00]+$")
    """Of a mesh: a binary STL or an OBJ; the path is relative to the task file."""
    color: Color | None = None
    """Red, green and blue from 0 to 1, if not the object's."""

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
    """What holds an object: a hinge (door, lid) or a slide (drawer), fixed to the world."""

    kind: Literal["hinge", "slide"]
    """`hinge` or `slide`."""
    axis: Vector
    """Its direction in the object's frame."""
    point: Vector = (0.0, 0.0, 0.0)
    """Of a hinge: a point on its axis, in the object's frame."""
    range: JointRange
    """Its ends, in degrees (within ±170) or metres (within ±1), measured from how the file places the object."""
    start: JointRange = (0.0, 0.0)
    """Where it stands at first, sampled in each trial."""
    friction: float = Field(default=0.02, ge=0, le=50, strict=True)
    """Of the joint itself (N m or N)."""

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
    """An object that can move."""

    name: Name
    """Small letters, digits, underscores; a cost reads `box` as `box_pos`, `box_quat` and so on."""
    label: str = Field(default="", max_length=60)
    """Its name for people."""
    parts: tuple[Shape, ...] = Field(min_length=1, max_length=12)
    """1 to 12 rigid parts."""
    mass_kg: MassRange
    """Range, within 0.005 to 20 kg; the planner does not know the mass."""
    friction: FrictionRange
    """Range, within 0.02 to 2: against table, fixtures and other objects, of which the larger counts. Against finger
    pads it is always 1."""
    scale: tuple[ScaleRange, ScaleRange, ScaleRange] = ((1.0, 1.0), (1.0, 1.0), (1.0, 1.0))
    """Three ranges of factors along its axes. The planner knows the scaled size. Round shapes stay round."""
    x: PositionRange
    """Range of the origin of its frame."""
    y: PositionRange
    """The same across."""
    z: Coordinate | None = None
    """Height of its origin; without it, the object stands on the table."""
    stands_on: Name | None = None
    """Another object, on whose top it stands; `x` and `y` are then measured from the origin of that one."""
    yaw_deg: AngleRange = (0.0, 0.0)
    """Range of its heading."""
    rpy_deg: Turn = (0.0, 0.0, 0.0)
    """How it is turned before the heading, for example to lie on its side."""
    points: dict[Name, Vector] = Field(default_factory=dict)
    """Named points on it, in its frame; a cost reads `handle` as `mug_handle_pos`."""
    symmetry: Literal["none", "box", "square-box", "cube", "cylinder", "sphere"] = "none"
    """Which turns look the same to a tracker: those of a `box`, `square-box`, `cube`, `cylinder`, `sphere`."""
    joint: Joint | None = None
    """What holds it."""
    color: Color = (0.76, 0.6, 0.42)
    """Its colour in pictures."""

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
    """As of an object."""
    size: Extents
    """Its edges."""
    position: Vector
    """Of its middle."""
    yaw_deg: Degrees = 0.0
    """Its heading."""
    friction: Friction = 0.6
    """Its own; between two bodies the larger counts."""
    color: Color = (0.55, 0.58, 0.62)
    """Its colour in pictures."""
    hidden: bool = Field(default=False, strict=True)
    """Whether neither planner, costs nor prompts know of it: for what only contact tells, as a step in a surface."""


class TableMark(TaskPart):
    """A coloured rectangle on the table under a place: seen in pictures, felt by nothing."""

    place: Name
    """The place that it lies under."""
    size: tuple[Metres, Metres] = (0.06, 0.06)
    """Along x and y."""
    color: Color
    """Red, green and blue from 0 to 1."""


class TableTop(TaskPart):
    """The table: its top face lies at z = 0."""

    size: Extents = (0.8, 0.8, 0.05)
    """Its edges."""
    center: tuple[Coordinate, Coordinate] = (0.0, 0.0)
    """Of its top, x and y."""
