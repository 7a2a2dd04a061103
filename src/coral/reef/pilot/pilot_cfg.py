"""How a robot decides: when it asks, what it does without an answer, how it drives meanwhile."""

from __future__ import annotations

from dataclasses import dataclass, field

from coral.advisor.consult import BudgetCfg
from coral.advisor.fallback import FOR_RUNS, Fallback
from coral.config import Count, NonNegative, Positive
from coral.reef.decide.trigger import TriggerCfg
from coral.reef.drive.monitor import MonitorCfg
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.pilot.guard import GuardCfg


@dataclass(frozen=True, kw_only=True)
class PilotCfg:
    """How decisions are asked for and what happens without them."""

    trigger: TriggerCfg = field(default_factory=TriggerCfg)
    monitor: MonitorCfg = field(default_factory=MonitorCfg)
    fields: CostFieldCfg = field(default_factory=CostFieldCfg)
    guard: GuardCfg = field(default_factory=GuardCfg)
    budget: BudgetCfg = field(default_factory=BudgetCfg)
    fallback: Fallback = FOR_RUNS
    """What happens when a decision was not reached within its budget: the rules decide, hold keeps the last goal and
    asks again, fail ends the mission. `coral reef bench` holds by default: there the advisor stands alone. Departs
    from the paper: its model always answers."""
    synchronous: bool = False
    """Stand still while a question is open, then drive for `action_s`: DREAM's protocol (paper IV-E), a baseline."""
    action_s: float = 1.0
    initial_m: float = 2.0
    """The initial waypoint lies this far ahead of the start (Alg. 1)."""
    blind_m: float = 6.0
    """It may lie up to this far, so that the robot need not stand still until the first answer comes."""
    first_s: float = 1.0
    """The first question is asked this long after the start. Departs from the paper: a map of one picture shows too
    little."""
    local_m: float = 5.0
    """How far about itself the robot keeps its distances to obstacles up to date; beyond the sensing range."""
    cost_to_go: bool = True
    """False is the ablation "w/o cost-to-go": the controller is given the straight distance to the goal, whatever lies
    between, as a local planner alone would have it. Departs from the paper: it describes no cost-to-go."""
    blind_speed_m_s: Positive = 0.3
    """Speed without a camera, half the cruise speed: if the sonar is lost too, the vehicle stands within 1 s."""
    passed_m: Positive = 0.45
    """Without a camera, water within this distance of where the vehicle has been is free: it fitted there. The hull,
    the controller's margin and a cell."""
    field_period_s: float = 1.0
    """Shortest time between updates of the cost-to-go when only the map has changed."""
    field_cells: Count = 200_000
    """A cost-to-go that searches more cells than this (some 8 ms) is left to the preparation thread; the robot drives
    by the last one meanwhile. On maps of up to 44 m it never does."""
    prepare_s: NonNegative = 0.3
    """Simulated time in which a question, or such a cost-to-go, is prepared from the belief as it was at its
    beginning. A real vehicle gets it as soon as it is there."""
