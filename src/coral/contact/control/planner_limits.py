"""What the planner of a run can do: the numbers of its configuration that the author of a cost has to know."""

from __future__ import annotations

from dataclasses import dataclass

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.reactive import ReactiveCfg


@dataclass(frozen=True)
class PlannerLimits:
    """How far, how often and how finely a run plans, and where its hand may go.

    Args:
        step_s: One control step.
        horizon_s: Time that a plan looks ahead.
        replan_s: Simulated time between two plans; conditions of stages are tested at each.
        late_s: Simulated time that passes while a plan is computed; 0 if the world stands still.
        samples: Rollouts per plan.
        speed_m_s: Maximum speed of the hand.
        turn_rad_s: Maximum angular speed of the hand.
        lead_m: Maximum distance of the hand's target from the hand when a plan begins.
        opening_m_s: Maximum speed at which the distance between the fingers changes.
        low_m: Lowest corner of the hand's workspace, x, y, z.
        high_m: Its highest corner.
        press_n: The largest force with which the hand presses.
        free_n: Force on table and fixtures above which rollouts count as worse; None if none does.
    """

    step_s: float
    horizon_s: float
    replan_s: float
    late_s: float
    samples: int
    speed_m_s: float
    turn_rad_s: float
    lead_m: float
    opening_m_s: float
    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]
    press_n: float
    free_n: float | None

    @classmethod
    def of(
        cls, cfg: ControllerCfg, step_s: float, replan_s: float, late_s: float = 0.0, press_n: float | None = None
    ) -> PlannerLimits:
        """Collect the limits of a controller.

        Args:
            cfg: The controller.
            step_s: One control step.
            replan_s: Simulated time between two plans.
            late_s: Simulated time that a plan takes.
            press_n: Limit of the reactive feedback; None for its default.
        """
        return cls(
            step_s,
            cfg.horizon * step_s,
            replan_s,
            late_s,
            cfg.mppi.samples,
            cfg.speed_m_s,
            cfg.turn_rad_s,
            cfg.lead_m,
            cfg.opening_m_s,
            cfg.workspace_low_m,
            cfg.workspace_high_m,
            ReactiveCfg().force_limit_n if press_n is None else press_n,
            cfg.press_free_n if cfg.press_weight else None,
        )
