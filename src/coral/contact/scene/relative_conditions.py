"""Conditions on two things: an object at another one, a peg in its hole, a door on its hinge."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, Field

from coral.contact.scene.condition import (
    Axis,
    BaseCondition,
    Metre,
    TaskLike,
    TrialLike,
    axis_of,
    check_known,
    degrees_between,
)
from coral.contact.scene.geometry import conjugate, rotate
from coral.contact.scene.observation import Truth
from coral.contact.scene.shapes import in_order
from coral.errors import InputError

SignedAngle = Annotated[float, Field(ge=-180, le=180, strict=True)]
FreeAxis = Literal["x", "-x", "y", "-y", "z", "-z"]


class AtObject(BaseCondition):
    """The object is at another one: its centre (or `point`) within `tolerance_m` of the other's (or `other_point`).

    `offset` (m) and `axes` are those of the other object's frame. With `tolerance_deg`, the two z axes are within that
    angle of each other.
    """

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["at-object"] = "at-object"
    other: str
    point: str | None = None
    other_point: str | None = None
    offset: tuple[Metre, Metre, Metre] = (0.0, 0.0, 0.0)
    tolerance_m: float = Field(gt=0, le=1, strict=True)
    axes: Literal["xy", "xyz", "x", "y", "z"] = "xy"
    tolerance_deg: float | None = Field(default=None, gt=0, le=180, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        off_m, off_deg = self._off(trial, truth)
        return off_m <= self.tolerance_m and (self.tolerance_deg is None or off_deg <= self.tolerance_deg)

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        off_m, off_deg = self._off(trial, truth)
        tilt = "" if self.tolerance_deg is None else f", and {off_deg:.0f}°, allowed {self.tolerance_deg:g}°"
        return f"{100 * off_m:.3g} cm, allowed {100 * self.tolerance_m:g} cm{tilt}"

    def _off(self, trial: TrialLike, truth: Truth) -> tuple[float, float]:
        """Return the distance (m) and the angle (deg) by which the object is off."""
        body, other = truth.objects[self.object], truth.objects[self.other]
        way = trial.point(self.object, self.point, body) - trial.point(self.other, self.other_point, other)
        off = rotate(conjugate(other.quaternion), way) - np.asarray(self.offset)
        kept = ["xyz".index(axis) for axis in self.axes]
        tilt = degrees_between(axis_of(other.quaternion, "z"), axis_of(body.quaternion, "z"))
        return float(np.linalg.norm(off[kept])), tilt


class Inserted(BaseCondition):
    """The object's `point` is `depth_m` behind a mouth, and within `tolerance_m` of the line into it.

    The mouth is a place of the task, or `other_point` on another object. `into` is the direction from the mouth inward,
    along an axis of the world or of the other object.
    """

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["inserted"] = "inserted"
    point: str
    place: str | None = None
    other: str | None = None
    other_point: str | None = None
    into: FreeAxis = "-z"
    depth_m: float = Field(gt=0, le=1, strict=True)
    tolerance_m: float = Field(default=0.02, gt=0, le=1, strict=True)

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        if (self.place is None) == (self.other is None):
            found = "place and other" if self.place else "neither"
            raise InputError(where, field, found, "a place, or an other object")
        if self.other is not None and self.other_point is None:
            raise InputError(where, f"{field}.other_point", "nothing", "a point on the other object: the mouth")
        if self.other is None and self.other_point is not None:
            raise InputError(where, f"{field}.other_point", self.other_point, "none without an other object")
        if self.place is not None:
            check_known(self.place, task.places, where, f"{field}.place")

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        if self.other is None:
            mouth, turn = np.asarray(trial.task.places[str(self.place)]), np.array([1.0, 0, 0, 0])
        else:
            other = truth.objects[self.other]
            mouth, turn = trial.point(self.other, self.other_point, other), other.quaternion
        axis: Axis = self.into[-1]  # type: ignore[assignment]
        inward = (-1.0 if self.into.startswith("-") else 1.0) * axis_of(turn, axis)
        way = trial.point(self.object, self.point, truth.objects[self.object]) - mouth
        depth = float(way @ inward)
        return depth >= self.depth_m and bool(np.linalg.norm(way - depth * inward) <= self.tolerance_m)


class Opened(BaseCondition):
    """The object's joint is within `between_deg` (a hinge) or `between_m` (a slide); 0 is how the file places it."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["opened"] = "opened"
    between_deg: Annotated[tuple[SignedAngle, SignedAngle], AfterValidator(in_order)] | None = None
    between_m: Annotated[tuple[Metre, Metre], AfterValidator(in_order)] | None = None

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        joint = task.object(self.object).joint
        if joint is None:
            raise InputError(where, f"{field}.object", self.object, "an object with a joint")
        wanted, other = ("between_deg", "between_m") if joint.kind == "hinge" else ("between_m", "between_deg")
        if getattr(self, other) is not None or getattr(self, wanted) is None:
            expected = f"{wanted}, as {self.object} is on a {joint.kind}"
            raise InputError(where, f"{field}.{other}", f"a {joint.kind}", expected)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        low, high = np.radians(self.between_deg) if self.between_deg is not None else self.between_m or (0.0, 0.0)
        return bool(low <= trial.joint_position(self.object, truth.objects[self.object]) <= high)

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        now = trial.joint_position(self.object, truth.objects[self.object])
        if self.between_deg is not None:
            return f"{np.degrees(now):.0f}°, allowed {self.between_deg[0]:g}° to {self.between_deg[1]:g}°"
        low, high = (100 * bound for bound in self.between_m or (0.0, 0.0))
        return f"{100 * now:.3g} cm, allowed {low:g} cm to {high:g} cm"
