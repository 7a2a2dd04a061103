"""One question of a set: what the advisor sees, and the key that scores the answer."""

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
from coral.reef.decide.answers import CentroidChoice, WaypointChoice
from coral.reef.decide.mission_answer import MissionAnswer

ANSWERS: Mapping[str, type[BaseModel]] = {
    "reef-centroid": CentroidChoice,
    "reef-waypoint": WaypointChoice,
    "reef-mission": MissionAnswer,
    "physical-parameters": ParameterEstimates,
    "contact-regions": RegionsAnswer,
    "object-poses": PosesAnswer,
    "parameter-repair": ParametersAnswer,
    "cost-function": PlanAnswer,
    "cost-repair": PlanAnswer,
    "unified": UnifiedAnswer,
}
"""Kinds of question and the type of their answers, in the order of tables."""


@dataclass(frozen=True, kw_only=True)
class ExamItem:
    """One question and its key."""

    id: str
    """Unique within its set, such as "reef-centroid-007"; also the name of its folder in an inbox."""
    kind: str
    """Kind of question."""
    group: str
    """World or task of the question; questions of one group resemble each other."""
    prompt: str
    """The text that the advisor reads."""
    prompt_version: str
    """Version of the template when the set was made."""
    facts: Mapping[str, Any]
    """For advisors that read no pictures; from the robot's own map and sensors."""
    pictures: tuple[Picture, ...] = ()
    """For advisors that read pictures."""
    asked_at_s: float = 0.0
    """Time at which the question came up, on the clock of its world."""
    key: Mapping[str, Any] = field(default_factory=dict)
    """The ground truth that scores the answer. `question` leaves it out."""

    def question(self) -> Question[Any]:
        """Return the part that an advisor sees, without the key."""
        return Question(
            kind=self.kind,
            prompt=self.prompt,
            answer_type=ANSWERS[self.kind],
            facts=self.facts,
            pictures=self.pictures,
            prompt_version=self.prompt_version,
            asked_at_s=self.asked_at_s,
        )
