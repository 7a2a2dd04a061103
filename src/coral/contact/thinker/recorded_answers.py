"""The first answers that a vision-language model gave to a shipped task, from the recordings of the package."""

from __future__ import annotations

from dataclasses import dataclass

from coral.advisor.recorded import CONTACT, is_recorded
from coral.advisor.recorded_attempts import find_recording, read_attempts
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.world_model.parameter_estimates import ParameterEstimates


@dataclass(frozen=True)
class RecordedAnswers:
    """Answers to the three questions at the beginning of an episode."""

    parameters: ParameterEstimates
    plan: PlanAnswer
    regions: RegionsAnswer


def recorded_answers(task: str) -> RecordedAnswers | None:
    """Return the first accepted answers of a task; None if nobody answered it."""
    if not is_recorded(task):
        return None
    name = f"{CONTACT}{task}"
    first = {
        entry["kind"]: entry["answer"]
        for entry in reversed(read_attempts(find_recording(name), name))
        if entry["verdict"] == "accepted"
    }
    return RecordedAnswers(
        ParameterEstimates.model_validate(first["physical-parameters"]),
        PlanAnswer.model_validate(first["cost-function"]),
        RegionsAnswer.model_validate(first.get("contact-regions", {})),
    )
