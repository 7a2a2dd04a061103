"""Conditions on the present state of one object: where it is, how it is turned, what touches it."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, Field

from coral.contact.scene.condition import (
    Axis,
    BaseCondition,
    Metre,
    Monitor,
    TaskLike,
    TrialLike,
    axis_of,
    check_known,
    degrees_between,
    touches,
)
from coral.contact.scene.observation import Array, BodyState, Contact, Truth
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

    def check(self, task: TaskLike, where: str, field: str) -> None:
        """See `BaseCondition.check`."""
        super().check(task, where, field)
        if self.most_m is not None and self.most_m <= self.height_m:
            raise InputError(where, f"{field}.most_m", self.most_m, f"more than height_m, {self.height_m:g}")

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        robot = {"hand", "left", "right", "robot"}
        highest = np.inf if self.most_m is None else self.most_m

        def holds(truth: Truth) -> bool:
            held_elsewhere = any(
                self.object in (pair.first, pair.second) and not robot & {pair.first, pair.second}
                for pair in truth.contacts
            )
            lowest = trial.lowest_point(self.object, truth.objects[self.object])
            return self.height_m <= lowest <= highest and not held_elsewhere

        return holds

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

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""

        def touched(truth: Truth, finger: str) -> bool:
            pair = {finger, self.object}
            found = [one for one in truth.contacts if {one.first, one.second} == pair]
            return any(self.point is None or near(truth, one) for one in found)

        def near(truth: Truth, contact: Contact) -> bool:
            point = trial.point(self.object, str(self.point), truth.objects[self.object])
            return bool(np.linalg.norm(contact.point - point) <= self.within_m)

        return lambda truth: all(touched(truth, finger) for finger in ("left", "right"))


class Released(BaseCondition):
    """No part of the hand touches the object."""

    kind: Literal["released"] = "released"

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        return lambda truth: not touches(truth, self.object, "hand")


class Touching(BaseCondition):
    """The object touches `thing`: a thing of the scene, or "hand"."""

    kind: Literal["touching"] = "touching"
    thing: str

    @property
    def also(self) -> tuple[str, ...]:
        """Return the names that `thing` may have besides those of fixed things and objects."""
        return ("hand",)

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        return lambda truth: touches(truth, self.object, self.thing)


class At(BaseCondition):
    """The object's centre, or a named point on it, is within `tolerance_m` of a place."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["at"] = "at"
    place: str
    point: str | None = None
    tolerance_m: float = Field(gt=0, le=1, strict=True)
    axes: Literal["xy", "xyz", "x", "y", "z"] = "xy"

    def check(self, task: TaskLike, where: str, field: str) -> None:
        """See `BaseCondition.check`."""
        super().check(task, where, field)
        if self.place in [item.name for item in task.objects]:
            raise InputError(where, f"{field}.place", self.place, "a name in places; kind at-object is for an object")
        check_known(self.place, task.places, where, f"{field}.place")

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        return lambda truth: self._off_m(trial, truth) <= self.tolerance_m

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        return f"{100 * self._off_m(trial, truth):.3g} cm, allowed {100 * self.tolerance_m:g} cm"

    def _off_m(self, trial: TrialLike, truth: Truth) -> float:
        way = _place(trial, self.object, self.point, truth.objects[self.object])
        way = way - np.asarray(trial.task.places[self.place])
        return float(np.linalg.norm(way[["xyz".index(axis) for axis in self.axes]]))


class Inside(BaseCondition):
    """The origin of the object's frame, or a named point on it, lies in the box from `low` to `high` (m, world)."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["inside"] = "inside"
    low: tuple[Metre, Metre, Metre]
    high: tuple[Metre, Metre, Metre]
    point: str | None = None

    def check(self, task: TaskLike, where: str, field: str) -> None:
        """See `BaseCondition.check`."""
        super().check(task, where, field)
        if any(low >= high for low, high in zip(self.low, self.high, strict=True)):
            raise InputError(where, f"{field}.low", list(self.low), f"all below high, {list(self.high)}")

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        low, high = np.asarray(self.low), np.asarray(self.high)

        def holds(truth: Truth) -> bool:
            place = _place(trial, self.object, self.point, truth.objects[self.object])
            return bool((low <= place).all() and (place <= high).all())

        return holds


def _place(trial: TrialLike, name: str, point: str | None, body: BodyState) -> Array:
    return body.position if point is None else trial.point(name, point, body)


class Resting(BaseCondition):
    """The object lies on `thing`, moving slower than 2 cm/s and 0.3 rad/s."""

    kind: Literal["resting"] = "resting"
    thing: str = "table"

    def check(self, task: TaskLike, where: str, field: str) -> None:
        """See `BaseCondition.check`."""
        super().check(task, where, field)
        if task.object(self.object).joint is not None and self.thing in task.things:
            raise InputError(
                where, f"{field}.thing", self.thing, "an object: one on a joint passes through fixed things"
            )

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        still = Still(object=self.object, speed_m_s=0.02, turn_rad_s=0.3).monitor(trial)
        return lambda truth: touches(truth, self.object, self.thing) and still(truth)


class Still(BaseCondition):
    """The object moves slower than `speed_m_s` and turns slower than `turn_rad_s`, wherever it is."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["still"] = "still"
    speed_m_s: float = Field(default=0.05, gt=0, le=10, strict=True)
    turn_rad_s: float = Field(default=0.5, gt=0, le=100, strict=True)

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""

        def holds(truth: Truth) -> bool:
            body = truth.objects[self.object]
            slow = np.linalg.norm(body.velocity) < self.speed_m_s
            return bool(slow and np.linalg.norm(body.angular_velocity) < self.turn_rad_s)

        return holds


class Flipped(BaseCondition):
    """The object's `axis` is turned by `degrees` from where it pointed at first, within `tolerance_deg`."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["flipped"] = "flipped"
    axis: Axis = "z"
    degrees: float = Field(default=90, ge=0, le=180, strict=True)
    tolerance_deg: float = Field(default=15, gt=0, le=90, strict=True)

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        return lambda truth: abs(self._turned_deg(trial, truth) - self.degrees) <= self.tolerance_deg

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """See `BaseCondition.found`."""
        allowed = f"allowed {self.degrees:g}° ± {self.tolerance_deg:g}°"
        return f"{self._turned_deg(trial, truth):.0f}°, {allowed}"

    def _turned_deg(self, trial: TrialLike, truth: Truth) -> float:
        before = axis_of(trial.objects[self.object].pose.quaternion, self.axis)
        return degrees_between(before, axis_of(truth.objects[self.object].quaternion, self.axis))


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

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        return lambda truth: self._off_deg(truth) <= self.tolerance_deg

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

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        return Flipped(object=self.object, axis="z", degrees=0, tolerance_deg=self.tolerance_deg).monitor(trial)


class Undisturbed(BaseCondition):
    """The object is within `tolerance_m` of where it stood at first, and its z axis within `tolerance_deg`."""

    needs_poses_only: ClassVar[bool] = True
    kind: Literal["undisturbed"] = "undisturbed"
    tolerance_m: float = Field(default=0.05, gt=0, le=1, strict=True)
    tolerance_deg: float = Field(default=15, gt=0, le=180, strict=True)

    def monitor(self, trial: TrialLike) -> Monitor:
        """See `BaseCondition.monitor`."""
        start = trial.objects[self.object].pose
        before = axis_of(start.quaternion, "z")

        def holds(truth: Truth) -> bool:
            body = truth.objects[self.object]
            near = np.linalg.norm(body.position - start.position) <= self.tolerance_m
            return bool(near and degrees_between(before, axis_of(body.quaternion, "z")) <= self.tolerance_deg)

        return holds
