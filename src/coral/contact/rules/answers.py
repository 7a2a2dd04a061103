"""The default advisor `heuristic`: the rule for each kind of question."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar, cast

from pydantic import BaseModel

from coral.advisor.question import AdvisorUnavailable, Rejection
from coral.advisor.setting import Rule
from coral.contact.plan.contact_regions import ObjectRegions, RegionsAnswer
from coral.contact.plan.plan_revision import PlanRevision
from coral.contact.plan.region_validation import UNTOUCHABLE
from coral.contact.rules.adjustments import adjustment_after, change_words
from coral.contact.rules.composition import Composed, compose
from coral.contact.rules.estimates import estimate_parameters
from coral.contact.rules.goals import NoRule, goal_words
from coral.contact.rules.outcome_cost import outcome_plan
from coral.contact.rules.poses import estimate_poses
from coral.contact.scene.facts import ObjectFacts
from coral.contact.thinker.diagnosis import TEXTS
from coral.contact.thinker.question_facts import CorrectionFacts, PlanFacts, RegionFacts
from coral.contact.thinker.unified_question import UnifiedAnswer
from coral.contact.world_model.parameter_correction import ObjectParameters, ParametersAnswer
from coral.contact.world_model.parameter_estimates import ParameterEstimate

F = TypeVar("F")


def _rule(answer: Callable[[F, Sequence[Rejection]], BaseModel]) -> Rule:
    """Adapt a rule to the advisor interface: advisors pass facts as untyped JSON, a rule takes those of its kind."""
    return cast(Rule, answer)


def _compose_plan(facts: PlanFacts, refused: int = 0) -> Composed:
    if not facts.get("contact_strategy", True):
        plan = outcome_plan(facts)
        if plan is None:
            asked = ", ".join(goal_words(goal) for goal in facts["goals"])
            raise AdvisorUnavailable("no-rule", f"no goal asks for anything to be moved: {asked}", final=True)
        return Composed(plan, RegionsAnswer({}))
    diagnoses = [*facts.get("diagnoses", ()), *["no-progress"] * refused]
    try:
        return compose(facts, adjustment_after(diagnoses))
    except NoRule as error:
        raise AdvisorUnavailable("no-rule", str(error), final=True) from None


def _plan(facts: PlanFacts, rejections: Sequence[Rejection]) -> BaseModel:
    return _compose_plan(facts, len(rejections)).plan


def _regions(facts: RegionFacts, rejections: Sequence[Rejection]) -> BaseModel:
    made = _compose_plan(facts, int(facts.get("refused", 0))).regions
    # If the advisor made the plan, its stages are others: then a region applies to all of them.
    stages = facts.get("stages", ())
    held = {
        name: [
            region if not stages or region.stage in stages else region.model_copy(update={"stage": ""})
            for region in regions.regions
        ]
        for name, regions in made.root.items()
    }
    # The rules cannot adjust a region further: drop it and keep the others.
    for rejection in rejections:
        if rejection.code in UNTOUCHABLE:
            held[rejection.details["object"]].pop(rejection.details["region"])
    return RegionsAnswer({name: ObjectRegions(regions=regions) for name, regions in held.items()})


def _repair(facts: PlanFacts, rejections: Sequence[Rejection]) -> BaseModel:
    diagnoses = list(facts["diagnoses"])
    made = _compose_plan(facts, len(rejections)).plan
    why = TEXTS[diagnoses[-1]]
    before, after = adjustment_after(diagnoses[:-1]), adjustment_after([*diagnoses, *["no-progress"] * len(rejections)])
    # A skill without another side or grasp must not claim to change it.
    change = change_words(
        before, after if _compose_plan({**facts, "diagnoses": diagnoses[:-1]}).plan != made else before
    )
    words = f"The plan before failed because {why}. {change}: {made.explanation}"
    return made.model_copy(update={"explanation": words})


def _keep_rehearsed(facts: PlanFacts, rejections: Sequence[Rejection]) -> BaseModel:
    return PlanRevision(keep=True, explanation="The rules do not read rehearsals.")


def _parameters(facts: CorrectionFacts, rejections: Sequence[Rejection]) -> BaseModel:
    fitted = facts["fitted"]
    if not fitted["better"]:
        raise AdvisorUnavailable("no-better-fit", "no mass and friction explain the history better", final=True)
    return ParametersAnswer(
        objects=[ObjectParameters(label=fitted["object"], mass=fitted["mass_kg"], friction=fitted["friction"])]
    )


def _unified(facts: PlanFacts, rejections: Sequence[Rejection]) -> BaseModel:
    """Apply the rule for each part in turn; keep known beliefs."""
    found = {
        name: ParameterEstimate(mass_kg=item["mass_kg"], friction_coeff=item["friction"])
        for name, item in facts["objects"].items()
        if "mass_kg" in item
    } or estimate_parameters(facts, rejections).root
    believed: dict[str, ObjectFacts] = {
        name: {**item, "mass_kg": found[name].mass_kg, "friction": found[name].friction_coeff}
        for name, item in facts["objects"].items()
    }
    made = _compose_plan({**facts, "objects": believed}, len(rejections))
    return UnifiedAnswer(parameters=found, regions=made.regions.root, **made.plan.model_dump())


RULES: Mapping[str, Rule] = {
    "physical-parameters": _rule(estimate_parameters),
    "cost-function": _rule(_plan),
    "contact-regions": _rule(_regions),
    "plan-revision": _rule(_keep_rehearsed),
    "cost-repair": _rule(_repair),
    "parameter-repair": _rule(_parameters),
    "object-poses": _rule(estimate_poses),
    "unified": _rule(_unified),
}
