"""Conditions on what has happened since the episode began; each keeps a history and is called at every control step."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from coral.contact.scene.condition import (
    AngleBand,
    Axis,
    BaseCondition,
    Monitor,
    StepClock,
    TrialLike,
    hand_force,
    touches,
    turned_deg,
)
from coral.contact.scene.observation import Truth


class TouchedWhileTurning(BaseCondition):
    """The object's `axis` was turned through `between_deg` against `thing`.

    It touched it for at least `for_s` in all, and during at least a third of that turn. Keeps a history: a flip made
    without the wall stays one, however the object leans there afterwards, until it is set down and turned again. A turn
    about the axis itself is none.
    """

    kind: Literal["touched-while-turning"] = "touched-while-turning"
    thing: str
    axis: Axis = "z"
    between_deg: AngleBand = (15.0, 75.0)
    for_s: float = Field(default=0.1, gt=0, le=10, strict=True)

    def _test(self, trial: TrialLike) -> Monitor:
        low, high = self.between_deg
        clock = StepClock()
        touched, against, reached, touching = 0.0, 0.0, low, False

        def holds(truth: Truth) -> bool:
            nonlocal touched, against, reached, touching
            span = clock.advance(truth)
            turned = turned_deg(trial, truth, self.object, self.axis)
            touched_before, touching = touching, touches(truth, self.object, self.thing)
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


class SteadyForce(BaseCondition):
    """While the hand pushed the object along, the force was `newtons` on average and seldom far from it.

    Counted are the times, at least `for_s`, at which the hand touches the object and it moves faster than `moving_m_s`.
    For at least `fraction` of them the net force, averaged over `window_s`, is within `tolerance` (a share) of
    `newtons`. With `deviation_n`, the root mean square of the difference, each control step by itself, is at most that:
    blows that average to `newtons` are no steady force.
    """

    reads_forces: ClassVar[bool] = True
    kind: Literal["steady-force"] = "steady-force"
    newtons: float = Field(gt=0, le=200, strict=True)
    tolerance: float = Field(default=0.4, gt=0, lt=1, strict=True)
    fraction: float = Field(default=0.7, gt=0, le=1, strict=True)
    moving_m_s: float = Field(default=0.005, ge=0, strict=True)
    window_s: float = Field(default=0.2, ge=0.001, le=2, strict=True)
    for_s: float = Field(default=1.0, ge=0, strict=True)
    deviation_n: float | None = Field(default=None, gt=0, le=200, strict=True)

    def _test(self, trial: TrialLike) -> Monitor:
        recent: list[tuple[float, float]] = []
        clock = StepClock()
        counted, within, squares = 0.0, 0.0, 0.0
        most = np.inf if self.deviation_n is None else self.deviation_n

        def holds(truth: Truth) -> bool:
            nonlocal counted, within, squares
            span = clock.advance(truth)
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
                    squares += span * (force - self.newtons) ** 2
            enough = counted >= self.for_s - 1e-9 and within >= self.fraction * counted - 1e-9
            return bool(enough and squares <= most**2 * counted + 1e-9)

        return holds


class PeakForce(BaseCondition):
    """The hand never pressed the object with more than `newtons`, averaged over `window_s` (0: a physics step).

    `newtons` times `window_s` limits the impulse of a blow.
    """

    # The window makes it a limit on blows rather than on their sharpness, which depends on the stiffness of contacts.

    breaks_for_good: ClassVar[bool] = True
    reads_forces: ClassVar[bool] = True
    kind: Literal["peak-force"] = "peak-force"
    newtons: float = Field(gt=0, le=500, strict=True)
    window_s: float = Field(default=0.0, ge=0, le=2, strict=True)

    def _test(self, trial: TrialLike) -> Monitor:
        recent: list[tuple[float, float]] = []

        def is_gentle(truth: Truth) -> bool:
            force = hand_force(truth, self.object) or 0.0
            if self.window_s == 0:
                measured = truth.hand_forces.get(self.object)
                return max(force, 0.0 if measured is None else measured.peak) <= self.newtons
            recent.append((truth.time_s, force))
            while recent[0][0] <= truth.time_s - self.window_s + 1e-9:
                recent.pop(0)
            # Before a whole window has passed, the missing steps count as without contact.
            steps = max(len(recent), round(self.window_s / _step_s(recent)))
            return sum(value for _, value in recent) / steps <= self.newtons

        return is_gentle


def _step_s(recent: list[tuple[float, float]]) -> float:
    """Return the duration of a control step (s); infinite before the second one."""
    return recent[-1][0] - recent[-2][0] if len(recent) > 1 else np.inf


class KeptLevel(BaseCondition):
    """The object's `axis` never left its initial direction by more than `tolerance_deg`."""

    needs_poses_only: ClassVar[bool] = True
    breaks_for_good: ClassVar[bool] = True
    kind: Literal["kept-level"] = "kept-level"
    axis: Axis = "z"
    tolerance_deg: float = Field(default=15, gt=0, le=180, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return turned_deg(trial, truth, self.object, self.axis) <= self.tolerance_deg


class KeptNear(BaseCondition):
    """The object's centre, or a named point on it, never was farther than `distance_m` from where it began."""

    needs_poses_only: ClassVar[bool] = True
    breaks_for_good: ClassVar[bool] = True
    kind: Literal["kept-near"] = "kept-near"
    point: str | None = None
    distance_m: float = Field(gt=0, le=5, strict=True)

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        before, now = trial.objects[self.object].pose, truth.objects[self.object]
        way = trial.point(self.object, self.point, now) - trial.point(self.object, self.point, before)
        return bool(np.linalg.norm(way) <= self.distance_m)


class KeptTouching(BaseCondition):
    """The object never left `thing` for longer than `for_s`: it was not carried."""

    # A pushed object chatters: shorter breaks count as touching.

    breaks_for_good: ClassVar[bool] = True
    kind: Literal["kept-touching"] = "kept-touching"
    thing: str = "table"
    for_s: float = Field(default=0.2, ge=0, le=10, strict=True)

    def _test(self, trial: TrialLike) -> Monitor:
        clock = StepClock()
        apart = 0.0

        def is_touching(truth: Truth) -> bool:
            nonlocal apart
            span = clock.advance(truth)
            apart = 0.0 if touches(truth, self.object, self.thing) else apart + span
            return apart <= self.for_s + 1e-9

        return is_touching


class NeverTouched(BaseCondition):
    """The object was never touched by `thing`: the table, a fixture, another object, "hand", or "robot" (the arm)."""

    breaks_for_good: ClassVar[bool] = True
    also: ClassVar[tuple[str, ...]] = ("hand", "robot")
    kind: Literal["never-touched"] = "never-touched"
    thing: str = "hand"

    def _holds(self, trial: TrialLike, truth: Truth) -> bool:
        return not touches(truth, self.object, self.thing)


class Slid(BaseCondition):
    """The hand slid the object at least `distance_m` along `thing`: the way made while both touched it."""

    kind: Literal["slid"] = "slid"
    thing: str = "table"
    distance_m: float = Field(gt=0, le=10, strict=True)

    def _test(self, trial: TrialLike) -> Monitor:
        way, before = 0.0, trial.objects[self.object].pose.position
        since_touch, clock = PUSHED_S + 1.0, StepClock()

        def holds(truth: Truth) -> bool:
            nonlocal way, before, since_touch
            position = truth.objects[self.object].position
            # An object under a push is hit and slides by itself in turn: the last touch counts for a moment.
            span = clock.advance(truth)
            since_touch = 0.0 if touches(truth, self.object, "hand") else since_touch + span
            if since_touch <= PUSHED_S and touches(truth, self.object, self.thing):
                way += float(np.linalg.norm(position - before))
            before = position
            return way >= self.distance_m - 1e-9

        return holds


PUSHED_S = 0.1
"""An object counts as pushed for this long after the hand's last touch."""
