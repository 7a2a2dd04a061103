"""The answer to a rehearsal: the plan is kept, or another one takes its place."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field, model_validator

from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, with_loops
from coral.contact.plan.plan_language import MOST_NAMES, MOST_STAGES, write_out


class PlanRevision(BaseModel):
    """The author's decision after the rehearsal of a plan.

    Args:
        keep: Whether the plan is kept as it is.
        code: `def state_cost(self)` of a new plan without stages.
        let, stages: Names for expressions, and the stages of a new plan, in order, as in `PlanAnswer`.
        explanation: Why.
    """

    keep: bool = False
    code: str = ""
    let: dict[str, str] = Field(default_factory=dict, max_length=MOST_NAMES)
    stages: list[StageAnswer] = Field(default_factory=list, max_length=MOST_STAGES, json_schema_extra=with_loops)
    explanation: str = ""

    @model_validator(mode="before")
    @classmethod
    def _written_out(cls, given: Any) -> Any:
        return write_out(given) if isinstance(given, dict) else given

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
