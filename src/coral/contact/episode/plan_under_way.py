"""The plan that the hand follows, and what was predicted for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.reactive import Reactive
from coral.contact.cost.context import Array
from coral.contact.scene.geometry import conjugate, multiply
from coral.contact.scene.observation import HandTarget, Observation


@dataclass
class PlanUnderWay:
    """A plan, from the step with which its execution begins."""

    plan: HandPlan
    first: int = 0
    """Index of that step. A plan that came late is used from where it still holds."""
    moved: Array | None = None
    turned: Array | None = None
    """Where the tool was at the beginning, relative to where it had been predicted, Shape=(3,) m and Shape=(4,): errors
    of the plan count from there, since earlier ones have been counted in the plan before. None: as predicted."""

    def __post_init__(self) -> None:
        self.next = self.first

    @classmethod
    def beginning(cls, plan: HandPlan, first: int, predicted: Observation, now: Observation) -> PlanUnderWay:
        """Begin a plan at step `first`, that was made from the state `predicted`."""
        position, quaternion = predicted.tool.position, predicted.tool.quaternion
        if first and plan.expected_position is not None and plan.expected_quaternion is not None:
            k = min(first, len(plan.expected_position)) - 1  # on a busy machine the robot outruns a plan
            position, quaternion = plan.expected_position[k], plan.expected_quaternion[k]
        turned = multiply(now.tool.quaternion, conjugate(quaternion))
        return cls(plan, first, now.tool.position - position, np.asarray(turned))

    def coming(self, steps: int) -> tuple[HandTarget, ...]:
        """Return the targets of the next steps; the last one stays when the plan is at its end."""
        targets = self.plan.targets
        return tuple(targets[min(self.next + k, len(targets) - 1)] for k in range(steps))

    def compare(self, k: int, now: Observation, reactive: Reactive) -> None:
        """Tell the feedback what step k was predicted to lead to, if it was predicted, and what it led to."""
        plan = self.plan
        positions, quaternions, forces = plan.expected_position, plan.expected_quaternion, plan.expected_force
        if positions is None or quaternions is None or forces is None or plan.expected_torque is None:
            return
        position, quaternion = positions[k], quaternions[k]
        if self.moved is not None and self.turned is not None:
            position, quaternion = position + self.moved, multiply(self.turned, quaternion)
        reactive.observe(position, forces[k], now, k - self.first, quaternion, plan.expected_torque[k])
