"""A contact task is a file: what is asked, what stands on the table, what varies between trials, when it is done.

Frames: world, metres, z up, the table's top at z = 0, x away from the robot. Lengths are full extents. Angles in files are
degrees. A range `[low, high]` is drawn anew in each trial; one number stands for both ends.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from coral.config import read_yaml
from coral.contact.conditions import Condition
from coral.errors import InputError, nearest

TASKS_DIR = Path(__file__).parent / "tasks"
FORMAT: Literal["coral-contact/1"] = "coral-contact/1"


def _as_range(value: Any) -> Any:
    return (value, value) if isinstance(value, int | float) and not isinstance(value, bool) else value


def _in_order(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError("the lower end of a range comes first")
    return value


Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,30}$")]
Metres = Annotated[float, Field(gt=0, le=10)]
Coordinate = Annotated[float, Field(ge=-10, le=10)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Extents = tuple[Metres, Metres, Metres]
Degrees = Annotated[float, Field(ge=-360, le=360)]


def _range_of(low: float, high: float) -> Any:
    end = Annotated[float, Field(ge=low, le=high)]
    return Annotated[tuple[end, end], BeforeValidator(_as_range), Field(validate_default=True)]


PositionRange = Annotated[tuple[Coordinate, Coordinate], BeforeValidator(_as_range)]
AngleRange = Annotated[tuple[Degrees, Degrees], BeforeValidator(_as_range)]
Mass = Annotated[float, Field(ge=0.005, le=20)]
MassRange = Annotated[tuple[Mass, Mass], BeforeValidator(_as_range)]
Friction = Annotated[float, Field(ge=0.02, le=2)]
FrictionRange = Annotated[tuple[Friction, Friction], BeforeValidator(_as_range)]
Scale = Annotated[float, Field(ge=0.2, le=5)]
ScaleRange = Annotated[tuple[Scale, Scale], BeforeValidator(_as_range)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @model_validator(mode="after")
    def _ranges(self) -> Any:
        for name, value in self:
            if isinstance(value, tuple) and len(value) == 2 and all(isinstance(end, float) for end in value):
                if value[0] > value[1]:
                    raise ValueError(f"{name}: the lower end of a range comes first")
        return self


class Shape(_Part):
    """One rigid piece of an object, at `position` and turned by `rpy_deg` (z-y-x) in the object's frame.

    `size`: box, full edges (x, y, z); cylinder, (diameter, diameter, length) along z; sphere, three times the diameter;
    mesh, the scale factors of `file` (STL or OBJ, its path relative to the task file).
    """

    shape: Literal["box", "cylinder", "sphere", "mesh"] = "box"
    size: Extents
    position: Vector = (0.0, 0.0, 0.0)
    rpy_deg: tuple[Degrees, Degrees, Degrees] = (0.0, 0.0, 0.0)
    file: str | None = None

    @model_validator(mode="after")
    def _round(self) -> Shape:
        if (self.shape == "mesh") != (self.file is not None):
            raise ValueError("a mesh, and nothing else, names its file")
        if self.shape in ("cylinder", "sphere") and self.size[0] != self.size[1]:
            raise ValueError(f"a {self.shape} is round: its first two sizes are equal")
        if self.shape == "sphere" and self.size[0] != self.size[2]:
            raise ValueError("a sphere is round: its three sizes are equal")
        return self


class Movable(_Part):
    """An object that moves.

    Args:
        parts: What it is made of; the object's frame is its own.
        mass_kg, friction: Drawn anew in each trial; unknown to the planner.
        scale: Factors on the three axes of all parts and points, drawn anew; the planner knows the result (known meshes).
        x, y: Where its frame's origin stands; z follows from resting on the table, or is `z`.
        yaw_deg: Its heading; `rpy_deg` turns it before that, as to lay it on a side.
        points: Named points on it, in its frame.
        symmetry: Which turns leave it looking the same.
        graspable: Where it may be held, for whoever proposes contacts; empty where nothing is said.
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
    yaw_deg: AngleRange = (0.0, 0.0)
    rpy_deg: tuple[Degrees, Degrees, Degrees] = (0.0, 0.0, 0.0)
    points: dict[Name, Vector] = Field(default_factory=dict)
    symmetry: Literal["none", "box", "square-box", "cube", "cylinder", "sphere"] = "none"
    color: tuple[float, float, float] = (0.76, 0.6, 0.42)


class Fixture(_Part):
    """A box that does not move, as a wall or the side of a bin."""

    name: Name
    size: Extents
    position: Vector
    yaw_deg: Degrees = 0.0
    friction: Friction = 0.6
    color: tuple[float, float, float] = (0.55, 0.58, 0.62)


class Table(_Part):
    """The table: its top face lies at z = 0."""

    size: Extents = (0.8, 0.8, 0.05)
    center: tuple[Coordinate, Coordinate] = (0.0, 0.0)


class Success(_Part):
    """When the task counts as done: all conditions hold, without a break, for `hold_s`."""

    hold_s: float = Field(default=0.5, ge=0, le=30)
    conditions: tuple[Condition, ...] = Field(min_length=1, max_length=12)


class Task(_Part):
    """A contact task; see `docs/contact-tasks.md` for the file format."""

    format: Literal["coral-contact/1"] = FORMAT
    name: str = Field(pattern=r"^[a-z0-9][a-z0-9-]{0,40}$")
    title: str = Field(min_length=1, max_length=80)
    instruction: str = Field(min_length=1, max_length=400)
    time_limit_s: float = Field(gt=0, le=600)
    table: Table = Table()
    fixtures: tuple[Fixture, ...] = Field(default=(), max_length=12)
    objects: tuple[Movable, ...] = Field(min_length=1, max_length=8)
    places: dict[Name, Vector] = Field(default_factory=dict)
    numbers: dict[Name, float] = Field(default_factory=dict)
    success: Success

    @model_validator(mode="after")
    def _names(self) -> Task:
        taken = ["table", "hand", "left", "right", "robot"]
        for thing in (*self.fixtures, *self.objects):
            if thing.name in taken:
                raise ValueError(f"the name {thing.name!r} is taken")
            taken.append(thing.name)
        return self

    def object(self, name: str) -> Movable:
        """The movable object of this name."""
        return next(item for item in self.objects if item.name == name)

    @property
    def things(self) -> tuple[str, ...]:
        """Names of what does not move: the table and the fixtures."""
        return ("table", *(item.name for item in self.fixtures))


def shipped_tasks() -> tuple[str, ...]:
    """Names of the tasks that come with the package, in the order of the paper."""
    known = {path.stem for path in TASKS_DIR.glob("*.yaml")}
    order = ("push-pick-board", "pick-box", "pick-clutter", "push-force", "flip-box", "flip-wall")
    return tuple(name for name in order if name in known) + tuple(sorted(known - set(order)))


def load_task(name_or_path: str | Path) -> Task:
    """A shipped task by name, or one from a file.

    Raises:
        InputError: No such task, or something in the file is wrong; the error names the field.
    """
    shipped = shipped_tasks()
    text = str(name_or_path)
    if text in shipped:
        path = TASKS_DIR / f"{text}.yaml"
    else:
        path = Path(name_or_path)
        if path.suffix not in (".yaml", ".yml") and not path.exists():
            close = nearest(text, shipped)
            raise InputError("task", "", text, f"one of {', '.join(shipped)}{close}, or a YAML file")
    content = read_yaml(path)
    try:
        task = Task.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(piece) for piece in first["loc"])
        found = first["input"] if isinstance(first["input"], str | int | float | bool) else type(first["input"]).__name__
        raise InputError(str(path), field, str(found), first["msg"].removeprefix("Value error, ").lower()) from None
    for condition in task.success.conditions:
        condition.check(task, str(path))
    return task


def task_schema() -> dict[str, Any]:
    """JSON schema of a task file."""
    schema = Task.model_json_schema()
    schema["title"] = "CoRAL contact task"
    return schema
