"""What of the thinking is on, and its thresholds."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from coral.advisor.consult import BudgetCfg
from coral.config import Count, NonNegative
from coral.contact.control.controller import ControllerCfg
from coral.contact.plan.contact_regions import RegionCfg
from coral.contact.thinker.progress_monitor import OuterCfg
from coral.contact.world_model.identification import IdentifyCfg
from coral.contact.world_model.parameter_estimates import ParameterBoundsCfg


@dataclass(frozen=True, kw_only=True)
class ThinkCfg:
    """What of CoRAL is on: the ablations switch parts off.

    Args:
        strategy: Say where to touch (off: `unguided`, the cost is of outcomes alone and no regions are asked for).
        regions: Ask for contact regions (off: `no-regions`, the plan stays as it is and the sampling is not guided).
        refine: Refine when stuck (off: `no-refinement`).
        unified: Everything in one question (the paper's unified VLM).
        tracking: Poses come from elsewhere (off: `no-tracking`, they are asked for once).
        least_gain: Share by which the best rehearsed way must lower the first stage's cost in a remembered plan.
        correct_every_s: Simulated time after which the world model is corrected by what was felt, stuck or not;
            0 for only when stuck.
        corrections: Most of these in an episode; the last is kept for its end.
        budget: Attempts and wall time for one decision. Simulated time stands still, and a model takes minutes to
            write and mend a program.
        belief: Bounds of what may be believed.
        region: Bounds of what regions may be.
        identify: The fit of corrections.
        outer: The outer loop.
    """

    strategy: bool = True
    regions: bool = True
    refine: bool = True
    unified: bool = False
    tracking: bool = True
    least_gain: float = 0.05
    correct_every_s: NonNegative = 0.0
    corrections: Count = 5
    budget: BudgetCfg = field(default_factory=lambda: BudgetCfg(deadline_s=600.0))
    belief: ParameterBoundsCfg = field(default_factory=ParameterBoundsCfg)
    region: RegionCfg = field(default_factory=RegionCfg)
    identify: IdentifyCfg = field(default_factory=IdentifyCfg)
    outer: OuterCfg = field(default_factory=OuterCfg)


def within(controller: ControllerCfg, think: ThinkCfg) -> ThinkCfg:
    """The same, told where a controller lets the hand go; bounds that were set for the regions themselves stay."""
    region, untold = think.region, RegionCfg()
    if (region.reach_low_m, region.reach_high_m) != (untold.reach_low_m, untold.reach_high_m):
        return think
    return replace(
        think, region=replace(region, reach_low_m=controller.workspace_low_m, reach_high_m=controller.workspace_high_m)
    )
