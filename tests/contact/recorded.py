"""The recorded model's answers as functions of facts, for tests that need an advisor of every kind of question."""

import json
from types import SimpleNamespace

from coral.advisor.question import AdvisorUnavailable
from coral.advisor.recorded_attempts import find_recording, read_attempts
from coral.advisor.replay import CONTACT
from coral.advisor.rules import RuleAdvisor
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.thinker.questions import UnifiedAnswer
from coral.contact.world_model.corrected_parameters import ObjectParameters, ParametersAnswer
from coral.contact.world_model.parameter_estimates import ParameterEstimates


def compose(facts):
    """Parameters, plan and regions of the task of these facts: the first accepted answers of its recording."""
    name = f"{CONTACT}{facts['task']}"
    attempts = reversed(read_attempts(find_recording(name), name))
    first = {entry["kind"]: entry["answer"] for entry in attempts if entry["verdict"] == "accepted"}
    return SimpleNamespace(
        parameters=ParameterEstimates.model_validate(first["physical-parameters"]),
        plan=PlanAnswer.model_validate(first["cost-function"]),
        regions=RegionsAnswer.model_validate(first.get("contact-regions", {})),
    )


def fitted(facts, rejections):
    """Masses and frictions as the replay of the history fits them, if that is better."""
    one = facts["fitted"]
    if not one["better"]:
        raise AdvisorUnavailable("no-better-fit", "nothing explains the history better", final=True)
    return ParametersAnswer(
        objects=[ObjectParameters(label=one["object"], mass=one["mass_kg"], friction=one["friction"])]
    )


def everything(facts, rejections):
    made = compose(facts)
    return UnifiedAnswer(parameters=made.parameters.root, regions=made.regions.root, **made.plan.model_dump())


def repaired(facts, rejections):
    plan = compose(facts).plan
    return plan.model_copy(update={"explanation": f"Once more. {plan.explanation}"})


def places(facts, rejections):
    """The recorded regions; of a plan with other stages they are for all of these."""
    made, stages = compose(facts).regions.model_dump(), facts.get("stages", ())
    for held in made.values():
        for region in held["regions"]:
            region["stage"] = region["stage"] if region["stage"] in stages else ""
    return RegionsAnswer.model_validate(made)


RULES = {
    "physical-parameters": lambda facts, rejections: compose(facts).parameters,
    "cost-function": lambda facts, rejections: compose(facts).plan,
    "contact-regions": places,
    "cost-repair": repaired,
    "parameter-repair": fitted,
    "unified": everything,
}

TYPES = {
    "physical-parameters": ParameterEstimates,
    "cost-function": PlanAnswer,
    "cost-repair": PlanAnswer,
    "contact-regions": RegionsAnswer,
}


def one_by_one(answers):
    """An advisor that gives these answers, as JSON by kind of question; a repair is the plan again."""
    given = {"cost-repair": answers["cost-function"], **answers}
    rules = {kind: lambda facts, rejections, kind=kind: TYPES[kind].model_validate(given[kind]) for kind in given}
    return RuleAdvisor(rules, "written")


def as_attempts(answers):
    """The same as the lines of an `attempts.jsonl`."""
    empty = dict.fromkeys(("prompt_version", "schema", "prompt_digest", "facts_digest", "code", "reason", "raw"), "")
    about = {"asked_at_s": 0.0, "answered_at_s": 0.0, "verdict": "accepted", "final": False, "pictures": []}
    lines = [
        json.dumps({**empty, **about, "usage": {}, "kind": kind, "answer": answer}) for kind, answer in answers.items()
    ]
    return "\n".join(lines) + "\n"
