"""What the planner of a run can do: the numbers of its configuration that the author of a cost has to know."""

from __future__ import annotations

from dataclasses import dataclass

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.reactive import ReactiveCfg


@dataclass(frozen=True)
class PlannerLimits:
    """How far, how often and how finely a run plans, and where its hand may go."""

    controller: ControllerCfg
    """Horizon, samples, speeds and workspace of its plans."""
    step_s: float
    """One control step."""
    replan_s: float
    """Simulated time between two plans; conditions of stages are tested at each."""
    late_s: float = 0.0
    """Simulated time that passes while a plan is computed; 0 if the world stands still."""
    press_n: float = ReactiveCfg().force_limit_n
    """The largest force with which the hand presses."""
    arm: bool = False
    """Whether the hand is an arm's, and does not fly."""

    @property
    def horizon_s(self) -> float:
        """Return the time that a plan looks ahead."""
        return self.controller.horizon * self.step_s

    @property
    def free_n(self) -> float | None:
        """Return the force on table and fixtures above which rollouts count as worse; None if none does."""
        return self.controller.press_free_n if self.controller.press_weight else None
