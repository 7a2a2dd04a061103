"""The answer to a rehearsal: the plan is kept, or another one takes its place."""

from __future__ import annotations

from pydantic import BaseModel, Field, model_validator

from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer


class PlanRevision(BaseModel):
    """The author's decision after the rehearsal of a plan.

    Args:
        keep: Whether the plan is kept as it is.
        code: `def state_cost(self)` of a new plan without stages.
        stages: Stages of a new plan, in order.
        explanation: Why.
    """

    keep: bool = False
    code: str = ""
    stages: list[StageAnswer] = Field(default_factory=list, max_length=16)
    explanation: str = ""

    @model_validator(mode="after")
    def _kept_or_new(self) -> PlanRevision:
        given = bool(self.code.strip() or self.stages)
        if self.keep == given:
            raise ValueError(
                "give either `keep`: true, or a new plan with `code` or `stages`; not both and not neither"
            )
        if given:
            self.plan_after(PlanAnswer(code="-"))
        return self

    def plan_after(self, before: PlanAnswer) -> PlanAnswer:
        """Return the plan that holds from now on.

        Args:
            before: The rehearsed plan.
        """
        if self.keep:
            return before
        return PlanAnswer(code=self.code, stages=self.stages, explanation=self.explanation)
