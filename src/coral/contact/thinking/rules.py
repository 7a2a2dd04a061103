"""The default advisor `heuristic`: an answer to each kind of question by rules, from facts alone. No model is asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from coral.advisor.question import AdvisorUnavailable, Rejection
from coral.advisor.rules import Rule
from coral.contact.thinking.beliefs import estimate
from coral.contact.thinking.compose import Composed, NoRule, compose
from coral.contact.thinking.repair import TEXTS, ObjectParameters, ParametersAnswer, change_words, choice_after


def _composed(facts: Mapping[str, Any], refused: int = 0) -> Composed:
    diagnoses = [*facts.get("diagnoses", ()), *["no-progress"] * refused]
    try:
        return compose(facts, choice_after(diagnoses))
    except NoRule as error:
        raise AdvisorUnavailable("no-rule", str(error), final=True) from None


def _plan(facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> BaseModel:
    return _composed(facts, len(rejections)).plan


def _regions(facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> BaseModel:
    return _composed(facts, int(facts.get("refused", 0))).regions


def _repair(facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> BaseModel:
    diagnoses = list(facts["diagnoses"])
    made = _composed(facts, len(rejections)).plan
    why = TEXTS.get(diagnoses[-1], diagnoses[-1])
    change = change_words(choice_after(diagnoses[:-1]), choice_after([*diagnoses, *["no-progress"] * len(rejections)]))
    words = f"The plan before failed because {why}. {change}: {made.explanation}"
    return made.model_copy(update={"explanation": words})


def _parameters(facts: Mapping[str, Any], rejections: Sequence[Rejection]) -> BaseModel:
    fitted = facts["fitted"]
    return ParametersAnswer(objects=[ObjectParameters(label=fitted["object"], mass=fitted["mass_kg"],
                                                      friction=fitted["friction"])])


RULES: Mapping[str, Rule] = {
    "physical-parameters": estimate, "cost-function": _plan, "contact-regions": _regions, "cost-repair": _repair,
    "parameter-repair": _parameters}
