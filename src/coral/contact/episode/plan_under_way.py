"""The plan that the hand follows, and what was predicted for it."""

from __future__ import annotations

from dataclasses import dataclass

from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.reactive import Reactive
from coral.contact.cost.context import Array
from coral.contact.scene.observation import HandTarget, Observation


@dataclass
class PlanUnderWay:
    """A plan, from the step with which its execution begins."""

    plan: HandPlan
    first: int = 0
    """Index of that step. A plan that came late is used from where it still holds."""
    moved: Array | None = None
    """Where the tool was at the beginning, relative to where it had been predicted, Shape=(3,) m: errors of the plan
    count from there, since earlier ones have been counted in the plan before. None: as predicted."""

    def __post_init__(self) -> None:
        self.next = self.first

    @classmethod
    def beginning(cls, plan: HandPlan, first: int, predicted: Observation, now: Observation) -> PlanUnderWay:
        """Begin a plan at step `first`, that was made from the state `predicted`."""
        position = predicted.tool.position
        if first and plan.expected_position is not None:
            # On a busy machine the robot outruns a plan.
            position = plan.expected_position[min(first, len(plan.expected_position)) - 1]
        return cls(plan, first, now.tool.position - position)

    def coming(self, steps: int) -> tuple[HandTarget, ...]:
        """Return the targets of the next steps; the last one stays when the plan is at its end."""
        targets = self.plan.targets
        return tuple(targets[min(self.next + k, len(targets) - 1)] for k in range(steps))

    def compare(self, k: int, now: Observation, reactive: Reactive) -> None:
        """Tell the feedback what step k was predicted to lead to, if it was predicted, and what it led to."""
        positions, forces = self.plan.expected_position, self.plan.expected_force
        if positions is not None and forces is not None:
            moved = 0.0 if self.moved is None else self.moved
            reactive.observe(positions[k] + moved, forces[k], now, k - self.first)
