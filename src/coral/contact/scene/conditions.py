"""Success conditions of a task, evaluated on the true state of the world.

A condition is a value from the task file. Its `monitor` is evaluated at every control step of one episode, and may keep
a history.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    SerializeAsAny,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

from coral.contact.scene.geometry import rotate
from coral.contact.scene.observation import Array, BodyState, Truth
from coral.contact.scene.shapes import in_order
from coral.errors import InputError, nearest
from coral.plugins import find_plugins, load_plugin

if TYPE_CHECKING:
    from coral.contact.scene.task import Task
    from coral.contact.scene.trial import Trial

Monitor = Callable[[Truth], bool]
Angle = Annotated[float, Field(ge=0, le=180, strict=True)]
Metre = Annotated[float, Field(ge=-10, le=10, strict=True)]
AXES = {"x": np.array([1.0, 0, 0]), "y": np.array([0, 1.0, 0]), "z": np.array([0, 0, 1.0])}


class BaseCondition(BaseModel):
    """One condition. A subclass with a `kind` of its own is one that task files may name; nothing else lists them."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    object: str
    kind: str

    def check(self, task: Task, where: str, field: str) -> None:
        """Check that all names in the condition exist.

        Args:
            task: The task of the condition.
            where: The file.
            field: Path of the condition in the file.

        Raises:
            InputError: A name does not exist.
        """
        objects = [item.name for item in task.objects]
        _check_known(self.object, objects, where, f"{field}.object")
        place = getattr(self, "place", None)
        if place is not None:
            _check_known(place, list(task.places), where, f"{field}.place")
        thing = getattr(self, "thing", None)
        if thing is not None:
            others = [name for name in (*task.things, *objects) if name != self.object]
            _check_known(thing, others, where, f"{field}.thing")

    def monitor(self, trial: Trial) -> Monitor:
        """Make a function that tells whether the condition holds; call it with the true state at every control step."""
        raise NotImplementedError


def _check_known(name: str, names: list[str], where: str, field: str) -> None:
    if name not in names:
        raise InputError(where, field, name, f"one of {', '.join(names) or 'none'}{nearest(name, names)}")


def _touching(truth: Truth, first: str, second: str) -> bool:
    pair = {first, second}
    return any({contact.first, contact.second} == pair for contact in truth.contacts)


class Lifted(BaseCondition):
    """The lowest point of the object is `height_m` above the table, and nothing but the hand touches it."""

    kind: Literal["lifted"] = "lifted"
    height_m: float = Field(gt=0, le=1, strict=True)

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""

        def holds(truth: Truth) -> bool:
            held_up = {"hand", "left", "right"}
            others = [
                pair
                for pair in truth.contacts
                if self.object in (pair.first, pair.second) and not held_up & {pair.first, pair.second}
            ]
            return trial.lowest_point(self.object, truth.objects[self.object]) >= self.height_m and not others

        return holds


class Grasped(BaseCondition):
    """Both fingers touch the object."""

    kind: Literal["grasped"] = "grasped"

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        return lambda truth: all(_touching(truth, self.object, finger) for finger in ("left", "right"))


class Released(BaseCondition):
    """No part of the hand touches the object."""

    kind: Literal["released"] = "released"

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        return lambda truth: not any(_touching(truth, self.object, part) for part in ("hand", "left", "right"))


class At(BaseCondition):
    """The object's centre, or a named point on it, is within `tolerance_m` of a place."""

    kind: Literal["at"] = "at"
    place: str
    point: str | None = None
    tolerance_m: float = Field(gt=0, le=1, strict=True)
    axes: Literal["xy", "xyz", "x", "y", "z"] = "xy"

    def check(self, task: Task, where: str, field: str) -> None:
        """See `BaseCondition.check`."""
        super().check(task, where, field)
        if self.point is not None:
            _check_known(self.point, list(task.object(self.object).points), where, f"{field}.point")

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        goal = np.asarray(trial.task.places[self.place])
        kept = ["xyz".index(axis) for axis in self.axes]

        def holds(truth: Truth) -> bool:
            body = truth.objects[self.object]
            place = body.position if self.point is None else trial.point(self.object, self.point, body)
            return bool(np.linalg.norm((place - goal)[kept]) <= self.tolerance_m)

        return holds


class Inside(BaseCondition):
    """The origin of the object's frame lies in the upright box from `low` to `high` (m, world frame)."""

    kind: Literal["inside"] = "inside"
    low: tuple[Metre, Metre, Metre]
    high: tuple[Metre, Metre, Metre]

    def check(self, task: Task, where: str, field: str) -> None:
        """See `BaseCondition.check`."""
        super().check(task, where, field)
        if any(low >= high for low, high in zip(self.low, self.high, strict=True)):
            raise InputError(where, f"{field}.low", list(self.low), f"all below high, {list(self.high)}")

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        low, high = np.asarray(self.low), np.asarray(self.high)

        def holds(truth: Truth) -> bool:
            place = truth.objects[self.object].position
            return bool((low <= place).all() and (place <= high).all())

        return holds


class Resting(BaseCondition):
    """The object lies on `thing`, moving slower than 2 cm/s and 0.3 rad/s."""

    kind: Literal["resting"] = "resting"
    thing: str = "table"

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""

        def holds(truth: Truth) -> bool:
            return _touching(truth, self.object, self.thing) and _is_slow(truth.objects[self.object])

        return holds


def _is_slow(body: BodyState) -> bool:
    return bool(np.linalg.norm(body.velocity) < 0.02 and np.linalg.norm(body.angular_velocity) < 0.3)


class Flipped(BaseCondition):
    """The object's `axis` is turned by `degrees` from where it pointed at first, within `tolerance_deg`."""

    kind: Literal["flipped"] = "flipped"
    axis: Literal["x", "y", "z"] = "z"
    degrees: float = Field(default=90, ge=0, le=180, strict=True)
    tolerance_deg: float = Field(default=15, gt=0, le=90, strict=True)

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        before = rotate(trial.objects[self.object].pose.quaternion, AXES[self.axis])

        def holds(truth: Truth) -> bool:
            turned = _degrees(before, rotate(truth.objects[self.object].quaternion, AXES[self.axis]))
            return abs(turned - self.degrees) <= self.tolerance_deg

        return holds


class Upright(BaseCondition):
    """The object stands as it stood at first, its z axis within `tolerance_deg`; where it points does not matter."""

    kind: Literal["upright"] = "upright"
    tolerance_deg: float = Field(default=15, gt=0, le=90, strict=True)

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        return Flipped(object=self.object, axis="z", degrees=0, tolerance_deg=self.tolerance_deg).monitor(trial)


class TouchedWhileTurning(BaseCondition):
    """The object's `axis` was turned through `between_deg` against `thing`.

    It touched it for at least `for_s` in all, and during at least a third of that turn. Keeps a history: a flip made
    without the wall stays one, however the object leans there afterwards, until it is set down and turned again. A turn
    about the axis itself is none.
    """

    kind: Literal["touched-while-turning"] = "touched-while-turning"
    thing: str
    axis: Literal["x", "y", "z"] = "z"
    between_deg: Annotated[tuple[Angle, Angle], AfterValidator(in_order)] = (15.0, 75.0)
    for_s: float = Field(default=0.1, gt=0, le=10, strict=True)

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        before = rotate(trial.objects[self.object].pose.quaternion, AXES[self.axis])
        low, high = self.between_deg
        touched, against, reached, last, touching = 0.0, 0.0, low, None, False

        def holds(truth: Truth) -> bool:
            nonlocal touched, against, reached, last, touching
            span, last = truth.time_s - (truth.time_s if last is None else last), truth.time_s
            turned = _degrees(before, rotate(truth.objects[self.object].quaternion, AXES[self.axis]))
            touched_before, touching = touching, _touching(truth, self.object, self.thing)
            if turned < low:
                touched, against, reached = 0.0, 0.0, low  # set down again: the history before is no part of the flip
                return False
            if turned <= high and touching:
                touched += span
            further = max(0.0, min(turned, high) - reached)
            reached += further
            if touching or touched_before:
                against += further
            return touched >= self.for_s - 1e-9 and against >= (high - low) / 3

        return holds


def _degrees(first: Array, second: Array) -> float:
    return float(np.degrees(np.arccos(np.clip(first @ second, -1, 1))))


class SteadyForce(BaseCondition):
    """While the hand pushed the object along, the force was `newtons` on average and seldom far from it.

    Counted are the times at which the hand touches the object and the object moves faster than `moving_m_s`; the force
    is the norm of the hand's net force, averaged over `window_s`. At least `fraction` of that time it lies within
    `tolerance` (a share of `newtons`), and the counted time is at least `for_s`.
    """

    kind: Literal["steady-force"] = "steady-force"
    newtons: float = Field(gt=0, le=200, strict=True)
    tolerance: float = Field(default=0.4, gt=0, lt=1, strict=True)
    fraction: float = Field(default=0.7, gt=0, le=1, strict=True)
    moving_m_s: float = Field(default=0.005, ge=0, strict=True)
    window_s: float = Field(default=0.2, ge=0.001, le=2, strict=True)
    for_s: float = Field(default=1.0, ge=0, strict=True)

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        recent: list[tuple[float, float]] = []
        counted, within, last = 0.0, 0.0, None

        def holds(truth: Truth) -> bool:
            nonlocal counted, within, last
            span, last = truth.time_s - (truth.time_s if last is None else last), truth.time_s
            force = hand_force(truth, self.object)
            if force is None:
                recent.clear()
            else:
                recent.append((truth.time_s, force))
                while recent[0][0] <= truth.time_s - self.window_s + 1e-9:
                    recent.pop(0)
                if np.linalg.norm(truth.objects[self.object].velocity) > self.moving_m_s:
                    mean = float(np.mean([value for _, value in recent]))
                    counted += span
                    within += span * (abs(mean - self.newtons) <= self.tolerance * self.newtons)
            return counted >= self.for_s - 1e-9 and within >= self.fraction * counted - 1e-9

        return holds


def hand_force(truth: Truth, name: str) -> float | None:
    """Compute the norm (N) of the hand's net force on the object; None without contact."""
    total, touching = np.zeros(3), False
    for contact in truth.contacts:
        if name in (contact.first, contact.second) and {"hand", "left", "right"} & {contact.first, contact.second}:
            touching = True
            total += contact.force if contact.second == name else -contact.force
    return float(np.linalg.norm(total)) if touching else None


class Undisturbed(BaseCondition):
    """The object has not been moved by more than `tolerance_m` from where it stood at first."""

    kind: Literal["undisturbed"] = "undisturbed"
    tolerance_m: float = Field(default=0.05, gt=0, le=1, strict=True)

    def monitor(self, trial: Trial) -> Monitor:
        """See `BaseCondition.monitor`."""
        start = trial.objects[self.object].pose.position
        return lambda truth: bool(np.linalg.norm(truth.objects[self.object].position - start) <= self.tolerance_m)


def _own_kinds_first(given: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    """Take conditions of other packages: an object as it is, a mapping whose kind an entry point names."""
    if isinstance(given, BaseCondition):
        return given
    kind = given.get("kind") if isinstance(given, dict) else None
    if not isinstance(kind, str) or kind in OURS:
        return handler(given)
    point = find_plugins("coral.conditions").get(kind)
    return handler(given) if point is None else load_plugin(point, "success.conditions").model_validate(given)


OURS = {kind.model_fields["kind"].default: kind for kind in BaseCondition.__subclasses__()}
"""Conditions that come with the package, by kind."""
if TYPE_CHECKING:
    Condition = BaseCondition
else:
    Condition = SerializeAsAny[
        Annotated[
            Union[tuple(OURS.values())],  # noqa: UP007
            Field(discriminator="kind"),
            WrapValidator(_own_kinds_first),
        ]
    ]
