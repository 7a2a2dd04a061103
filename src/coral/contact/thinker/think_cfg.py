"""Which parts of the outer loop are enabled, and their thresholds."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from coral.advisor.consult import BudgetCfg
from coral.advisor.fallback import FOR_RUNS, Fallback
from coral.advisor.registry import asks_person
from coral.config import Count, NonNegative
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.plan.contact_regions import RegionCfg, reach_box
from coral.contact.thinker.progress_monitor import OuterCfg
from coral.contact.world_model.identification import IdentifyCfg
from coral.contact.world_model.parameter_estimates import ParameterBoundsCfg

MODEL_S = 600.0
"""A model takes minutes to write and mend a program."""
DESK_S = 86_400.0
"""A person at the desk may take a day."""


@dataclass(frozen=True, kw_only=True)
class ThinkCfg:
    """Which parts of the outer loop are enabled; an ablation disables one."""

    strategy: bool = True
    """Whether plans say where to touch. Off (`unguided`): the cost is of outcomes alone, and no regions are asked for.
    """
    regions: bool = True
    """Whether to ask for contact regions. Off (`no-regions`): the same plan, but nothing guides the samples."""
    refine: bool = True
    """Whether to ask for another plan when stuck. Off: `no-refinement`."""
    unified: bool = False
    """Whether everything is one question (the paper's unified VLM)."""
    tracking: bool = True
    """Whether objects are tracked. Off (`no-tracking`): the advisor is asked for their poses once."""
    least_gain: float = 0.05
    """Share by which the best rehearsed way must lower the first stage's cost in a remembered plan."""
    correct_every_s: NonNegative = 0.0
    """Simulated time after which the world model is corrected by what was felt, stuck or not; 0 for only when stuck."""
    corrections: Count = 5
    """Most of these in an episode; the last is kept for its end."""
    budget: BudgetCfg = field(default_factory=BudgetCfg)
    """Attempts and wall time for one decision."""
    fallback: Fallback = FOR_RUNS
    """What happens where the advisor does not decide: `rules` stand in for it, or the episode ends (`hold`, and `fail`,
    whose end reason names the failure)."""
    latency: str = "auto"
    """Simulated time of an answer: 0, SECONDS, fixed:SECONDS, lognormal:MEDIAN:SIGMA, measured, recorded; paper for 2.3
    s (questions with a picture), 1.5 s (a plan) and 3 s (a repair); auto for 0 of rules and persons, measured of
    models, recorded of recordings."""
    meanwhile: Literal["go-on", "hold"] = "go-on"
    """What the hand does in that time, once there is a plan: go on with it, or hold still."""
    belief: ParameterBoundsCfg = field(default_factory=ParameterBoundsCfg)
    """Bounds of what may be believed."""
    region: RegionCfg = field(default_factory=RegionCfg)
    """Bounds of what regions may be."""
    identify: IdentifyCfg = field(default_factory=IdentifyCfg)
    """The fit of corrections."""
    outer: OuterCfg = field(default_factory=OuterCfg)
    """The outer loop."""


def decision_budget(cfg: BudgetCfg, advisor: str) -> BudgetCfg:
    """Attempts and time of one decision.

    Args:
        cfg: What was set.
        advisor: As on the command line.
    """
    return cfg.within(DESK_S if asks_person(advisor) else MODEL_S)


def resolved(think: ThinkCfg, controller: ControllerCfg, advisor: str) -> ThinkCfg:
    """Return the configuration with a number for everything that is None.

    Args:
        think: The outer loop.
        controller: Where it lets the hand go, regions may lie.
        advisor: As on the command line; a person has more time than a model.
    """
    low, high = reach_box(think.region, controller)
    return replace(
        think,
        region=replace(think.region, reach_low_m=low, reach_high_m=high),
        budget=decision_budget(think.budget, advisor),
    )
