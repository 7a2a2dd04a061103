"""Conditions on the present state of one object: where it is, how it is turned, what touches it."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, Field

from coral.contact.scene.condition import (
    HAND_PARTS,
    Axis,
    BaseCondition,
    Metre,
    TaskLike,
    TrialLike,
    axis_of,
    check_known,
    degrees_between,
    touches,
    turned_deg,
)
from coral.contact.scene.observation import BodyState, Truth
from coral.errors import InputError


def _not_zero(value: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(value):
        raise ValueError("a direction, not all zero")
    return value


Direction = Annotated[tuple[Metre, Metre, Metre], AfterValidator(_not_zero)]


class Lifted(BaseCondition):
    """The lowest point of the object is `height_m` above the table, and nothing but the robot touches it.

    With `most_m`, the lowest point is not above that height.
    """

    kind: Literal["lifted"] = "lifted"
    height_m: float = Field(gt=0, le=1, strict=True)
    most_m: float | None = Field(default=None, gt=0, le=1, strict=True)

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        if self.most_m is not None and self.most_m <= self.height_m:
            raise InputError(where, f"{field}.most_m", self.most_m, f"more than height_m, {self.height_m:g}")

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        robot = {*HAND_PARTS, "robot"}
        held_elsewhere = any(
            self.object in (pair.first, pair.second) and not robot & {pair.first, pair.second}
            for pair in truth.contacts
        )
        lowest, highest = trial.lowest_point(self.object, truth.objects[self.object]), self.most_m or np.inf
        return self.height_m <= lowest <= highest and not held_elsewhere

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        lowest = trial.lowest_point(self.object, truth.objects[self.object])
        most = "" if self.most_m is None else f", at most {100 * self.most_m:g} cm"
        return f"{100 * lowest:.3g} cm, wanted {100 * self.height_m:g} cm{most}"


class Grasped(BaseCondition):
    """Both fingers touch the object; with `point`, both within `within_m` of that point on it."""

    kind: Literal["grasped"] = "grasped"
    point: str | None = None
    within_m: float = Field(default=0.05, gt=0, le=1, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        point = trial.point(self.object, self.point, truth.objects[self.object])
        touching = {
            finger
            for finger in ("left", "right")
            for one in truth.contacts
            if {one.first, one.second} == {finger, self.object}
            and (self.point is None or np.linalg.norm(one.point - point) <= self.within_m)
        }
        return len(touching) == 2


class Released(BaseCondition):
    """No part of the hand touches the object."""

    kind: Literal["released"] = "released"

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return not touches(truth, self.object, "hand")


class Touching(BaseCondition):
    """The object touches `thing`: a thing of the scene, or "hand"."""

    also: ClassVar[tuple[str, ...]] = ("hand",)
    kind: Literal["touching"] = "touching"
    thing: str

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return touches(truth, self.object, self.thing)


class At(BaseCondition):
    """The object's centre, or a named point on it, is within `tolerance_m` of a place."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["at"] = "at"
    place: str
    point: str | None = None
    tolerance_m: float = Field(gt=0, le=1, strict=True)
    axes: Literal["xy", "xyz", "x", "y", "z"] = "xy"

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        if self.place in [item.name for item in task.objects]:
            raise InputError(where, f"{field}.place", self.place, "a name in places; kind at-object is for an object")
        check_known(self.place, task.places, where, f"{field}.place")

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return self._off_m(trial, truth) <= self.tolerance_m

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        return f"{100 * self._off_m(trial, truth):.3g} cm, allowed {100 * self.tolerance_m:g} cm"

    def _off_m(self, trial: TrialLike, truth: Truth) -> float:
        point = trial.point(self.object, self.point, truth.objects[self.object])
        way = point - np.asarray(trial.task.places[self.place])
        return float(np.linalg.norm(way[["xyz".index(axis) for axis in self.axes]]))


class Inside(BaseCondition):
    """The origin of the object's frame, or a named point on it, lies in the box from `low` to `high` (m, world)."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["inside"] = "inside"
    low: tuple[Metre, Metre, Metre]
    high: tuple[Metre, Metre, Metre]
    point: str | None = None

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        if any(low >= high for low, high in zip(self.low, self.high, strict=True)):
            raise InputError(where, f"{field}.low", list(self.low), f"all below high, {list(self.high)}")

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        point = trial.point(self.object, self.point, truth.objects[self.object])
        return bool((np.asarray(self.low) <= point).all() and (point <= np.asarray(self.high)).all())


class Resting(BaseCondition):
    """The object lies on `thing`, moving slower than 2 cm/s and 0.3 rad/s."""

    kind: Literal["resting"] = "resting"
    thing: str = "table"

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        if task.object(self.object).joint is not None and self.thing in task.things:
            expected = "an object: one on a joint passes through fixed things"
            raise InputError(where, f"{field}.thing", self.thing, expected)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return touches(truth, self.object, self.thing) and _is_slow(truth.objects[self.object], 0.02, 0.3)


class Still(BaseCondition):
    """The object moves slower than `speed_m_s` and turns slower than `turn_rad_s`, wherever it is."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["still"] = "still"
    speed_m_s: float = Field(default=0.05, gt=0, le=10, strict=True)
    turn_rad_s: float = Field(default=0.5, gt=0, le=100, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return _is_slow(truth.objects[self.object], self.speed_m_s, self.turn_rad_s)


def _is_slow(body: BodyState, speed_m_s: float, turn_rad_s: float) -> bool:
    return bool(np.linalg.norm(body.velocity) < speed_m_s and np.linalg.norm(body.angular_velocity) < turn_rad_s)


class Flipped(BaseCondition):
    """The object's `axis` is turned by `degrees` from where it pointed at first, within `tolerance_deg`."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["flipped"] = "flipped"
    axis: Axis = "z"
    degrees: float = Field(default=90, ge=0, le=180, strict=True)
    tolerance_deg: float = Field(default=15, gt=0, le=90, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return abs(turned_deg(trial, truth, self.object, self.axis) - self.degrees) <= self.tolerance_deg

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        allowed = f"allowed {self.degrees:g}° ± {self.tolerance_deg:g}°"
        return f"{turned_deg(trial, truth, self.object, self.axis):.0f}°, {allowed}"


class Pointing(BaseCondition):
    """The object's `axis` points along `direction` (world) within `tolerance_deg`, or, if `either_way`, against it.

    It says on which side an object lies, and to which side it fell.
    """

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["pointing"] = "pointing"
    axis: Axis = "z"
    direction: Direction
    tolerance_deg: float = Field(default=15, gt=0, le=90, strict=True)
    either_way: bool = Field(default=False, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return self._off_deg(truth) <= self.tolerance_deg

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        return f"{self._off_deg(truth):.0f}° off, allowed {self.tolerance_deg:g}°"

    def _off_deg(self, truth: Truth) -> float:
        wanted = np.asarray(self.direction) / np.linalg.norm(self.direction)
        off = degrees_between(wanted, axis_of(truth.objects[self.object].quaternion, self.axis))
        return min(off, 180 - off) if self.either_way else off


class Upright(BaseCondition):
    """The object stands as it stood at first, its z axis within `tolerance_deg`; where it points does not matter."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["upright"] = "upright"
    tolerance_deg: float = Field(default=15, gt=0, le=90, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return turned_deg(trial, truth, self.object, "z") <= self.tolerance_deg


class Undisturbed(BaseCondition):
    """The object is within `tolerance_m` of where it stood at first, and its z axis within `tolerance_deg`."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["undisturbed"] = "undisturbed"
    tolerance_m: float = Field(default=0.05, gt=0, le=1, strict=True)
    tolerance_deg: float = Field(default=15, gt=0, le=180, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        moved = truth.objects[self.object].position - trial.objects[self.object].pose.position
        near = bool(np.linalg.norm(moved) <= self.tolerance_m)
        return near and turned_deg(trial, truth, self.object, "z") <= self.tolerance_deg
