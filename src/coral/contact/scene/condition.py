"""What every success condition has: an object, a check of the names in it, and a monitor of the true state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Annotated, ClassVar, Literal, Protocol

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from coral.contact.scene.geometry import rotate
from coral.contact.scene.observation import Array, BodyState, Truth
from coral.contact.scene.shapes import Movable, Vector, in_order
from coral.errors import InputError, nearest

Monitor = Callable[[Truth], bool]
Angle = Annotated[float, Field(ge=0, le=180, strict=True)]
AngleBand = Annotated[tuple[Angle, Angle], AfterValidator(in_order)]
Metre = Annotated[float, Field(ge=-10, le=10, strict=True)]
Axis = Literal["x", "y", "z"]
AXES = {"x": np.array([1.0, 0, 0]), "y": np.array([0, 1.0, 0]), "z": np.array([0, 0, 1.0])}
HAND_PARTS = ("hand", "left", "right")
"""Names of the hand's parts in contacts."""


class TaskLike(Protocol):
    """What a condition reads of a `Task`, which consists of conditions itself."""

    @property
    def objects(self) -> tuple[Movable, ...]: ...  # noqa: D102
    @property
    def places(self) -> Mapping[str, Vector]: ...  # noqa: D102
    @property
    def things(self) -> tuple[str, ...]: ...  # noqa: D102
    def object(self, name: str) -> Movable: ...  # noqa: D102


class TrialObjectLike(Protocol):
    """What a condition reads of a `TrialObject`."""

    @property
    def pose(self) -> BodyState: ...  # noqa: D102


class TrialLike(Protocol):
    """What a condition reads of a `Trial`."""

    @property
    def task(self) -> TaskLike: ...  # noqa: D102
    @property
    def objects(self) -> Mapping[str, TrialObjectLike]: ...  # noqa: D102
    def point(self, name: str, point: str | None, body: BodyState) -> Array: ...  # noqa: D102
    def joint_position(self, name: str, body: BodyState) -> float: ...  # noqa: D102
    def lowest_point(self, name: str, body: BodyState) -> float: ...  # noqa: D102


class BaseCondition(BaseModel):
    """One condition. A subclass with a `kind` of its own is one that task files may name; nothing else lists them."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    object: str
    kind: str

    needs_poses_only: ClassVar[bool] = False
    """Whether poses and velocities decide the condition. If not, it reads contacts, which no robot measures."""
    breaks_for_good: ClassVar[bool] = False
    """Whether the condition can never hold again once it has not held."""
    reads_forces: ClassVar[bool] = False
    """Whether it depends on how hard things touch, not only on whether they do."""
    also: ClassVar[tuple[str, ...]] = ()
    """Names that `thing` may have besides those of fixed things and objects."""

    @property
    def reads_contacts(self) -> bool:
        """Return whether the condition depends on who touches whom or how hard."""
        return not self.needs_poses_only

    def check(self, task: TaskLike, where: str, field: str) -> None:
        """Check that all names in the condition exist.

        Raises:
            InputError: A name does not exist.
        """
        objects = [item.name for item in task.objects]
        check_known(self.object, objects, where, f"{field}.object")
        point = getattr(self, "point", None)
        if point is not None:
            check_known(point, task.object(self.object).points, where, f"{field}.point")
        thing = getattr(self, "thing", None)
        if thing is not None:
            others = [name for name in (*task.things, *objects) if name != self.object]
            check_known(thing, [*self.also, *others], where, f"{field}.thing")
        other, other_point = getattr(self, "other", None), getattr(self, "other_point", None)
        if other is not None:
            check_known(other, [name for name in objects if name != self.object], where, f"{field}.other")
        if other is not None and other_point is not None:
            check_known(other_point, task.object(other).points, where, f"{field}.other_point")
        self._check_more(task, where, field)

    def _check_more(self, task: TaskLike, where: str, field: str) -> None:
        """Check what a condition of this kind has beyond the names of object, point and thing."""

    def monitor(self, trial: TrialLike) -> Monitor:
        """Make a function that says whether the condition holds; call it with the true state at every control step."""
        test = self._test(trial)
        if not self.breaks_for_good:
            return test
        intact = True

        def holds(truth: Truth) -> bool:
            nonlocal intact
            intact = test(truth) and intact
            return intact

        return holds

    def _test(self, trial: TrialLike) -> Monitor:
        """Make the function that is called at every control step; one with a history keeps it here."""
        return partial(self._holds, trial)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        """Check a state by itself."""
        raise NotImplementedError

    def found(self, trial: TrialLike, truth: Truth) -> str:
        """Return what is measured now and what is allowed, as "5.4 cm, allowed 3 cm"; "" where no number tells it."""
        return ""


def check_known(name: str, names: Iterable[str], where: str, field: str) -> None:
    """Check that a name is one of those that exist.

    Raises:
        InputError: It is not; the error suggests the nearest one.
    """
    names = list(names)
    if name not in names:
        raise InputError(where, field, repr(name), f"one of {', '.join(names) or 'none'}{nearest(name, names)}")


def touches(truth: Truth, name: str, thing: str) -> bool:
    """Check whether two named things touch; the thing "hand" stands for all parts of the hand."""
    others = set(HAND_PARTS) if thing == "hand" else {thing}
    return any(
        (name == one.first and one.second in others) or (name == one.second and one.first in others)
        for one in truth.contacts
    )


def axis_of(quaternion: Array, name: Axis) -> Array:
    """Compute the direction, Shape=(3,), of an axis of an orientation."""
    return rotate(quaternion, AXES[name])


def degrees_between(first: Array, second: Array) -> float:
    """Compute the angle (deg) between two unit vectors."""
    return float(np.degrees(np.arccos(np.clip(first @ second, -1, 1))))


def turned_deg(trial: TrialLike, truth: Truth, name: str, axis: Axis) -> float:
    """Compute the angle (deg) between an object's axis now and where it pointed at first."""
    before, now = trial.objects[name].pose.quaternion, truth.objects[name].quaternion
    return degrees_between(axis_of(before, axis), axis_of(now, axis))


def hand_force(truth: Truth, name: str) -> float | None:
    """Compute the norm (N) of the hand's net force on an object; None without contact.

    It is the mean over the last control step where the world measures that, otherwise the force at its end.
    """
    if name in truth.hand_forces:
        mean = truth.hand_forces[name].mean
        return None if mean is None else float(np.linalg.norm(mean))
    total, touching = np.zeros(3), False
    for contact in truth.contacts:
        if name in (contact.first, contact.second) and set(HAND_PARTS) & {contact.first, contact.second}:
            touching = True
            total += contact.force if contact.second == name else -contact.force
    return float(np.linalg.norm(total)) if touching else None


class StepClock:
    """Time between the calls of a monitor; the first call has no predecessor, so its time does not count."""

    def __init__(self) -> None:
        self._last: float | None = None

    def advance(self, truth: Truth) -> float:
        """Return the time (s) since the last call."""
        span = 0.0 if self._last is None else truth.time_s - self._last
        self._last = truth.time_s
        return span
