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
    """How long all must hold without a break (s)."""
    conditions: tuple[Condition, ...] = Field(min_length=1, max_length=12)
    """1 to 12 conditions, each with its `kind`."""


class Task(TaskPart):
    """The file itself."""

    format: Literal["coral-contact/1"] = FORMAT
    """May be left out."""
    name: str = Field(pattern=r"^[a-z0-9][a-z0-9-]{0,40}$")
    """Small letters, digits, dashes."""
    title: str = Field(min_length=1, max_length=80)
    """For people."""
    instruction: str = Field(min_length=1, max_length=400)
    """What is to be done, for people and for the model."""
    time_limit_s: float = Field(gt=0, le=600, strict=True)
    """Simulated seconds, at most 600."""
    table: TableTop = TableTop()
    """Its size and place."""
    fixtures: tuple[Fixture, ...] = Field(default=(), max_length=12)
    """What does not move."""
    objects: tuple[Movable, ...] = Field(min_length=1, max_length=8)
    """1 to 8 objects that can move."""
    places: dict[Name, Vector] = Field(default_factory=dict)
    """Named points of the world; a cost reads `goal` as `goal_pos`."""
    marks: tuple[TableMark, ...] = Field(default=(), max_length=12)
    """What shows places in pictures."""
    numbers: dict[Name, Number] = Field(default_factory=dict)
    """Named numbers that a cost can read."""
    success: Success
    """When the task is done."""

    def object(self, name: str) -> Movable:
        """Return the movable object of this name."""
        return next(item for item in self.objects if item.name == name)

    @property
    def known(self) -> Task:
        """Return the task as planner and advisor know it: without hidden fixtures."""
        seen = tuple(item for item in self.fixtures if not item.hidden)
        return self if len(seen) == len(self.fixtures) else self.model_copy(update={"fixtures": seen})

    @property
    def things(self) -> tuple[str, ...]:
        """Return the names of all fixed things: the table and the fixtures."""
        return ("table", *(item.name for item in self.fixtures))
