"""The judge: decides from the true state whether an episode has succeeded, or has failed for good."""

from __future__ import annotations

import math

import numpy as np

from coral.contact.scene.condition import BaseCondition
from coral.contact.scene.geometry import conjugate, from_rotvec, rotate, rotation_of
from coral.contact.scene.observation import Array, Truth
from coral.contact.scene.shapes import Fixture
from coral.contact.scene.trial import Trial, corners

BELOW_TABLE_M = 0.03
"""An object this far below the table's top has left the table or passed through it."""
PRESSED_M = 0.005
"""Two bodies may penetrate each other by this much: contacts are soft."""


class Judge:
    """Judges one episode."""

    def __init__(self, trial: Trial) -> None:
        self._trial = trial
        self._success = trial.task.success
        self._monitors = [condition.monitor(trial) for condition in self._success.conditions]
        # An object's own origin may lie anywhere, for example at its foot.
        self._hulls = {name: trial.corners(name) for name in trial.objects}
        self._middle = {name: (found.min(axis=0) + found.max(axis=0)) / 2 for name, found in self._hulls.items()}
        self._solid: dict[str, Array] = {}
        """A point inside each object."""
        for item in trial.task.objects:
            first = item.model_copy(update={"parts": item.parts[:1]})
            self._solid[item.name] = corners(first, trial.objects[item.name].scale).mean(axis=0)
        self._before: dict[str, Array] = {}
        self._since: float | None = None
        self.holding: tuple[bool, ...] = ()

    def success(self, truth: Truth) -> bool:
        """Check whether all conditions have held long enough. Call it at every control step."""
        self.holding = tuple(monitor(truth) for monitor in self._monitors)
        if not all(self.holding):
            self._since = None
            return False
        if self._since is None:
            self._since = truth.time_s
        return truth.time_s - self._since >= self._success.hold_s - 1e-9

    @property
    def broken(self) -> tuple[BaseCondition, ...]:
        """Return the conditions that do not hold and can never hold again, as of the last call of `success`."""
        conditions = self._success.conditions[: len(self.holding)]
        return tuple(
            one for one, holds in zip(conditions, self.holding, strict=True) if one.breaks_for_good and not holds
        )

    def failure(self, truth: Truth) -> str | None:
        """Return why the episode has failed for good, or None. Call it at every control step."""
        table = self._trial.task.table
        for name, body in truth.objects.items():
            point = body.position + rotate(body.quaternion, self._solid[name])
            before, self._before[name] = self._before.get(name, point), point
            near = (fixture for fixture in self._trial.task.fixtures if _may_cross(fixture, before, point))
            if any(_crosses(fixture, before, point) for fixture in near):
                return f"tunnelling: {name}"
            if body.position[2] + (self._hulls[name] @ rotation_of(body.quaternion)[2]).min() > -BELOW_TABLE_M:
                continue
            middle = body.position + rotate(body.quaternion, self._middle[name])
            over_table = all(abs(middle[k] - table.center[k]) < table.size[k] / 2 for k in (0, 1))
            if over_table and middle[2] < 0:
                return f"tunnelling: {name}"
            if middle[2] < -BELOW_TABLE_M - 0.1:
                return f"dropped: {name}"
        return None


def _may_cross(fixture: Fixture, first: Array, second: Array) -> bool:
    """Check whether the first point is as near to a fixture as the segment and the fixture are long."""
    return math.dist(first, fixture.position) <= math.dist(first, second) + math.hypot(*fixture.size) / 2


def _crosses(fixture: Fixture, first: Array, second: Array) -> bool:
    """Check whether the segment from the first point to the second passes through a fixture."""
    back = conjugate(from_rotvec([0.0, 0.0, np.radians(fixture.yaw_deg)]))
    start, end = (rotate(back, point - np.asarray(fixture.position)) for point in (first, second))
    half = np.asarray(fixture.size) / 2
    half = half - np.minimum(PRESSED_M, half / 2)
    way = np.where(np.abs(end - start) < 1e-12, 1e-12, end - start)
    ends = np.stack([(-half - start) / way, (half - start) / way])
    return bool(max(0.0, ends.min(axis=0).max()) <= min(1.0, ends.max(axis=0).min()))
