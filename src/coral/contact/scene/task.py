"""A contact task: instruction, objects, ranges of the trials, conditions of success.

Frames: world, metres, z up, the table's top at z = 0, x away from the robot. Lengths are full extents. Angles in files
are degrees. A range `[low, high]` is sampled in each trial; a single number is a range of one value.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from coral.contact.scene.conditions import Condition
from coral.contact.scene.shapes import Fixture, Movable, Name, Number, TableMark, TableTop, TaskPart, Vector

FORMAT: Literal["coral-contact/1"] = "coral-contact/1"


class Success(TaskPart):
    """When the task counts as done: all conditions hold, without a break, for `hold_s`."""

    hold_s: float = Field(default=0.5, ge=0, le=30, strict=True)
    conditions: tuple[Condition, ...] = Field(min_length=1, max_length=12)


class Task(TaskPart):
    """A contact task; see `docs/reference/task-file.md` for the file format."""

    format: Literal["coral-contact/1"] = FORMAT
    name: str = Field(pattern=r"^[a-z0-9][a-z0-9-]{0,40}$")
    title: str = Field(min_length=1, max_length=80)
    instruction: str = Field(min_length=1, max_length=400)
    time_limit_s: float = Field(gt=0, le=600, strict=True)
    table: TableTop = TableTop()
    fixtures: tuple[Fixture, ...] = Field(default=(), max_length=12)
    objects: tuple[Movable, ...] = Field(min_length=1, max_length=8)
    places: dict[Name, Vector] = Field(default_factory=dict)
    marks: tuple[TableMark, ...] = Field(default=(), max_length=12)
    numbers: dict[Name, Number] = Field(default_factory=dict)
    success: Success

    def object(self, name: str) -> Movable:
        """Return the movable object of this name."""
        return next(item for item in self.objects if item.name == name)

    @property
    def things(self) -> tuple[str, ...]:
        """Return the names of all fixed things: the table and the fixtures."""
        return ("table", *(item.name for item in self.fixtures))
