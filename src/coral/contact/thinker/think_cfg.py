"""Which parts of the outer loop are enabled, their thresholds, and what stands where the advisor does not decide."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from coral.advisor.consult import BudgetCfg
from coral.advisor.fallback import failed
from coral.advisor.registry import asks_person
from coral.config import NonNegative
from coral.contact.memory.memory import MemoryCfg
from coral.contact.thinker.progress_monitor import OuterCfg
from coral.contact.world_model.identification import IdentifyCfg

Told = Literal["paper", "words", "full"]
"""How much a question about a plan tells."""
MODEL_S = 600.0
"""A model takes minutes to write and repair a program."""
DESK_S = 86_400.0
"""A person at the desk may take a day."""
StandIn = Literal["prior", "hold", "fail"]
"""prior: prior masses and frictions, no contact regions, and the previous plan are used; without any plan the
episode ends. hold: the episode ends, and its reason names the open decision; only a plan without regions continues.
fail: it ends, and its reason names the failure."""


@dataclass(frozen=True, kw_only=True)
class ThinkCfg:
    """Which parts of the outer loop are enabled; an ablation disables one."""

    prompt: Told = "full"
    """What a question about a plan tells: `paper`, the sentence, poses and parameters, and it asks for one cost;
    `words`, also pictures, shapes, scene, hand and planner, and stages are allowed; `full`, also every condition of
    success with its thresholds. Departs from the paper: its A.8 to A.10 are `paper`, and zero-shot means that there."""
    strategy: bool = True
    """Whether plans name contact regions. Off (`unguided`): the cost rates outcomes alone, no regions are asked for.
    """
    regions: bool = True
    """Whether to ask for contact regions. Off (`no-regions`): the same plan, but the samples are not guided."""
    refine: bool = True
    """Whether to ask for another plan when stuck. Off: `no-refinement`."""
    unified: bool = False
    """Whether to ask one question for everything (the paper's unified VLM)."""
    tracking: bool = True
    """Whether objects are tracked. Off (`no-tracking`): the advisor is asked for their poses once."""
    correct_every_s: NonNegative = 0.0
    """Simulated time between corrections of the world model while not stuck; 0 corrects only when stuck."""
    budget: BudgetCfg = field(default_factory=BudgetCfg)
    """Attempts and wall time of one decision."""
    fallback: StandIn = "prior"
    """What happens where the advisor does not decide: `prior` masses and frictions, no regions and the plan before; or
    the episode ends (`hold`, or `fail`, whose end reason names the failure)."""
    latency: str = "auto"
    """Simulated latency of an answer: 0, SECONDS, fixed:SECONDS, lognormal:MEDIAN:SIGMA, measured, recorded, paper or
    auto. `paper` is 2.3 s (questions with a picture), 1.5 s (a plan) or 3 s (a repair); `auto` is 0 for persons,
    measured for models, recorded for recordings."""
    memory: MemoryCfg = field(default_factory=MemoryCfg)
    """Retrieval of remembered plans."""
    identify: IdentifyCfg = field(default_factory=IdentifyCfg)
    """Fit of world-model corrections."""
    outer: OuterCfg = field(default_factory=OuterCfg)
    """Thresholds of the outer loop."""


def decision_budget(cfg: BudgetCfg, advisor: str) -> BudgetCfg:
    """Return attempts and time of one decision; a person gets more time than a model."""
    return cfg.within(DESK_S if asks_person(advisor) else MODEL_S)


class NoDecision(RuntimeError):
    """The advisor did not decide, and the chosen policy lets nothing else stand."""

    def __init__(self, policy: StandIn, what: str, failure: str) -> None:
        self.end_reason = failed(failure) if policy == "fail" else f"no-decision: {what}"
        why = (
            "nothing can stand for it"
            if policy == "prior"
            else f"the fallback policy {policy!r} lets nothing else decide"
        )
        super().__init__(f"the advisor did not decide on the {what} ({failure}), and {why}")


def stand_in(emit: Callable[..., None], policy: StandIn, what: str, failure: str, by: str) -> None:
    """Report that the advisor did not decide and what stands instead: `by`, "" if nothing can.

    Raises:
        NoDecision: Nothing does.
    """
    stands = policy == "prior" and bool(by)
    who = by if stands else "nobody"
    emit("fallback", what=what, by=who, because=failure, policy=policy, decided=what, source="fallback")
    if not stands:
        raise NoDecision(policy, what, failure)
