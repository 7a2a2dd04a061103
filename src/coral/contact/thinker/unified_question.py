"""Perception and planning in one question: the ablation with a unified VLM (section 4, Table 1).

The paper says only that it "uses a single multimodal prompt for both perception and planning". The consequences drawn
here are listed in docs/reference/task-questions.md, "Ablations".
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field

from coral.contact.plan.contact_regions import ObjectRegions, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.thinker.repair_prompt import fit_prompt
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.contact.world_model.parameter_estimates import ParameterEstimate, ParameterEstimates

KIND = "unified"


class UnifiedAnswer(PlanAnswer):
    """A plan together with what it is a plan for.

    Args:
        parameters: Mass and friction by the objects' names.
        regions: Where to touch, by the objects' names.
    """

    parameters: dict[str, ParameterEstimate]
    regions: dict[str, ObjectRegions] = Field(default_factory=dict)

    @property
    def estimates(self) -> ParameterEstimates:
        """Return the estimates in the form of their own question."""
        return ParameterEstimates(self.parameters)

    @property
    def places(self) -> RegionsAnswer:
        """Return the regions in the form of their own question."""
        return RegionsAnswer(self.regions)

    @property
    def plan(self) -> PlanAnswer:
        """Return the plan in the form of its own question."""
        return PlanAnswer(code=self.code, stages=self.stages, begin=self.begin, explanation=self.explanation)


def unified_prompt(shown: Mapping[str, Any], cfg: ThinkCfg, history: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return the placeholders of the single question; `history` is what a repair says of the plan that failed."""
    prompt: dict[str, Any] = {**shown, "places": cfg.regions, "code": "", "error": ""}
    return prompt if history is None else fit_prompt(KIND, {**prompt, **history})
