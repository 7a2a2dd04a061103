"""A contact task is a file: what is asked, what stands on the table, what varies between trials, when it is done.

Frames: world, metres, z up, the table's top at z = 0, x away from the robot. Lengths are full extents. Angles in files
are degrees. A range `[low, high]` is drawn anew in each trial; one number stands for both ends.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)

from coral.config import read_yaml
from coral.contact.conditions import Condition, in_order
from coral.contact.task_check import check_task
from coral.errors import InputError, nearest
from coral.faults import input_error

TASKS_DIR = Path(__file__).parent / "tasks"
FORMAT: Literal["coral-contact/1"] = "coral-contact/1"


def _as_range(value: Any) -> Any:
    return (value, value) if isinstance(value, int | float) and not isinstance(value, bool) else value


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
AngleRange = Annotated[tuple[Degrees, Degrees], BeforeValidator(_as_range), AfterValidator(in_order)]
MassRange = Annotated[tuple[Mass, Mass], BeforeValidator(_as_range), AfterValidator(in_order)]
FrictionRange = Annotated[tuple[Friction, Friction], BeforeValidator(_as_range), AfterValidator(in_order)]
ScaleRange = Annotated[tuple[Factor, Factor], BeforeValidator(_as_range), AfterValidator(in_order)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Shape(_Part):
    """One rigid piece of an object, at `position` and turned by `rpy_deg` (z-y-x) in the object's frame.

    `size`: box, full edges (x, y, z); cylinder, (diameter, diameter, length) along z; sphere, three times the diameter;
    mesh, the factors on `file` (STL or OBJ; its path relative to the task file, once loaded absolute). What touches is
    the hull of a mesh.
    """

    shape: Literal["box", "cylinder", "sphere", "mesh"] = "box"
    size: Extents
    position: Vector = (0.0, 0.0, 0.0)
    rpy_deg: Turn = (0.0, 0.0, 0.0)
    file: str | None = Field(default=None, pattern=r"^[^\x00]+$")

    @model_validator(mode="after")
    def _round(self) -> Shape:
        if (self.shape == "mesh") != (self.file is not None):
            raise ValueError("a mesh with its file, or another shape without one")
        if self.shape in ("cylinder", "sphere") and self.size[0] != self.size[1]:
            raise ValueError(f"a {self.shape} whose first two sizes are equal")
        if self.shape == "sphere" and self.size[0] != self.size[2]:
            raise ValueError("a sphere whose three sizes are equal")
        return self


class Movable(_Part):
    """An object that moves.

    Args:
        parts: What it is made of; the object's frame is its own.
        mass_kg, friction: Drawn anew in each trial; unknown to the planner.
        scale: Factors on the three axes of all parts and points, drawn anew; the planner knows the result (known
            meshes).
        x, y: Where its frame's origin stands; z follows from resting on the table, or is `z`.
        yaw_deg: Its heading; `rpy_deg` turns it before that, as to lay it on a side.
        points: Named points on it, in its frame.
        symmetry: Which turns leave it looking the same.
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
    rpy_deg: Turn = (0.0, 0.0, 0.0)
    points: dict[Name, Vector] = Field(default_factory=dict)
    symmetry: Literal["none", "box", "square-box", "cube", "cylinder", "sphere"] = "none"
    color: Color = (0.76, 0.6, 0.42)


class Fixture(_Part):
    """A box that does not move, as a wall or the side of a bin."""

    name: Name
    size: Extents
    position: Vector
    yaw_deg: Degrees = 0.0
    friction: Friction = 0.6
    color: Color = (0.55, 0.58, 0.62)


class Table(_Part):
    """The table: its top face lies at z = 0."""

    size: Extents = (0.8, 0.8, 0.05)
    center: tuple[Coordinate, Coordinate] = (0.0, 0.0)


class Success(_Part):
    """When the task counts as done: all conditions hold, without a break, for `hold_s`."""

    hold_s: float = Field(default=0.5, ge=0, le=30, strict=True)
    conditions: tuple[Condition, ...] = Field(min_length=1, max_length=12)


class Task(_Part):
    """A contact task; see `docs/contact-tasks.md` for the file format."""

    format: Literal["coral-contact/1"] = FORMAT
    name: str = Field(pattern=r"^[a-z0-9][a-z0-9-]{0,40}$")
    title: str = Field(min_length=1, max_length=80)
    instruction: str = Field(min_length=1, max_length=400)
    time_limit_s: float = Field(gt=0, le=600, strict=True)
    table: Table = Table()
    fixtures: tuple[Fixture, ...] = Field(default=(), max_length=12)
    objects: tuple[Movable, ...] = Field(min_length=1, max_length=8)
    places: dict[Name, Vector] = Field(default_factory=dict)
    numbers: dict[Name, Number] = Field(default_factory=dict)
    success: Success

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
    """A shipped task by name, one from a file, or a LIBERO scene (`libero:object/0`).

    Raises:
        InputError: No such task, or something in the file is wrong; the error names the field.
    """
    shipped = shipped_tasks()
    text = str(name_or_path)
    if text.startswith("libero:"):
        from coral.contact.libero.scene import load_libero

        return load_libero(text)
    if text in shipped:
        path = TASKS_DIR / f"{text}.yaml"
    else:
        path = Path(name_or_path)
        if path.suffix not in (".yaml", ".yml") and not path.exists():
            close = nearest(text, shipped)
            raise InputError("task", "", text, f"one of {', '.join(shipped)}{close}, or a YAML file")
    try:
        task = Task.model_validate(read_yaml(path))
    except ValidationError as error:
        raise input_error(str(path), error, Task) from None
    task = _with_files(task, path.parent)
    check_task(task, str(path))
    return task


def _with_files(task: Task, folder: Path) -> Task:
    """The task with the paths of meshes made absolute."""

    def placed(part: Shape) -> Shape:
        return part if part.file is None else part.model_copy(update={"file": str((folder / part.file).resolve())})

    objects = tuple(
        item.model_copy(update={"parts": tuple(placed(part) for part in item.parts)}) for item in task.objects
    )
    return task.model_copy(update={"objects": objects})


def task_schema() -> dict[str, Any]:
    """JSON schema of a task file."""
    schema = Task.model_json_schema()
    schema["title"] = "CoRAL contact task"
    return schema


if __name__ == "__main__":
    (TASKS_DIR / "schema.json").write_text(json.dumps(task_schema(), indent=1) + "\n", encoding="utf-8")
