"""One question of a set: what the advisor is shown, and apart from it what its answer is scored by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from coral.advisor.question import Picture, Question
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.thinker.pose_question import PosesAnswer
from coral.contact.thinker.unified_question import UnifiedAnswer
from coral.contact.world_model.parameter_correction import ParametersAnswer
from coral.contact.world_model.parameter_estimates import ParameterEstimates
from coral.reef.answers import CentroidChoice, WaypointChoice

ANSWERS: Mapping[str, type[BaseModel]] = {
    "reef-centroid": CentroidChoice,
    "reef-waypoint": WaypointChoice,
    "physical-parameters": ParameterEstimates,
    "contact-regions": RegionsAnswer,
    "object-poses": PosesAnswer,
    "parameter-repair": ParametersAnswer,
    "cost-function": PlanAnswer,
    "cost-repair": PlanAnswer,
    "unified": UnifiedAnswer,
}
"""Kinds of question and what they are answered with, in the order of tables."""


@dataclass(frozen=True, kw_only=True)
class ExamItem:
    """One question and its key."""

    id: str
    """Unique within its set, such as "reef-centroid-007"; also the name of its folder in an inbox."""
    kind: str
    """Of question."""
    group: str
    """World or task that it comes from: questions of one group resemble each other."""
    prompt: str
    """As an advisor reads it."""
    prompt_version: str
    """Of the template when the set was made."""
    facts: Mapping[str, Any]
    """For advisors without eyes; from the robot's own map and sensors."""
    pictures: tuple[Picture, ...] = ()
    """For advisors with eyes."""
    asked_at_s: float = 0.0
    """When it came up, on the clock of its world."""
    key: Mapping[str, Any] = field(default_factory=dict)
    """What the answer is scored by: ground truth. `question` leaves it out."""

    def question(self) -> Question[Any]:
        """What an advisor is shown, and nothing else."""
        return Question(
            kind=self.kind,
            prompt=self.prompt,
            answer_type=ANSWERS[self.kind],
            facts=self.facts,
            pictures=self.pictures,
            prompt_version=self.prompt_version,
            asked_at_s=self.asked_at_s,
        )
