"""Perception and planning in one question: the ablation with a unified VLM (section 4, Table 1).

The paper says that it "uses a single multimodal prompt for both perception and planning", and no more. What follows
from that here is decided in one place, docs/contact-mind.md, "Ablations".
"""

from __future__ import annotations

from pydantic import Field

from coral.contact.thinking.beliefs import Estimate, Estimates
from coral.contact.thinking.plan_answer import PlanAnswer
from coral.contact.thinking.regions import ObjectRegions, RegionsAnswer


class UnifiedAnswer(PlanAnswer):
    """A plan together with what it is a plan for.

    Args:
        parameters: Mass and friction by the objects' names.
        regions: Where to touch, by the objects' names.
    """

    parameters: dict[str, Estimate]
    regions: dict[str, ObjectRegions] = Field(default_factory=dict)

    @property
    def estimates(self) -> Estimates:
        """As the question about them alone would have it."""
        return Estimates(self.parameters)

    @property
    def places(self) -> RegionsAnswer:
        """As the question about them alone would have it."""
        return RegionsAnswer(self.regions)

    @property
    def plan(self) -> PlanAnswer:
        """As the question about it alone would have it."""
        return PlanAnswer(code=self.code, stages=self.stages, explanation=self.explanation)
