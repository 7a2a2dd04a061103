import numpy as np
import pytest
from pydantic import ValidationError
from recorded import RULES, compose

from coral.advisor.question import Question
from coral.contact.mistakes.crude import SPOILT, spoil
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.plan.plan_check import verify_plan
from coral.contact.plan.region_validation import verify_regions
from coral.contact.world_model.parameter_estimates import ParameterEstimates, verify_estimates

ERRORS = ("wrong_type", "out_of_range", "backward", "stale")


@pytest.mark.parametrize("error", ERRORS)
@pytest.mark.parametrize(
    ("kind", "answer_type"),
    [("physical-parameters", ParameterEstimates), ("cost-function", PlanAnswer), ("contact-regions", RegionsAnswer)],
)
def test_a_spoilt_answer_is_refused_and_the_right_one_is_not(scene, kind, answer_type, error):
    one = scene("pick-box")
    right = RULES[kind](one.facts, ())
    check = {
        "physical-parameters": lambda answer: verify_estimates(answer, one.sizes),
        "cost-function": lambda answer: verify_plan(answer, one.world.schema, one.samples),
        "contact-regions": lambda answer: verify_regions(answer, one.facts, compose(one.facts).plan.names),
    }[kind]
    assert check(right) is None
    question = Question(kind=kind, prompt="", answer_type=answer_type, facts=one.facts)
    spoilt = spoil(error, question, right.model_dump(mode="json"), np.random.default_rng(0))
    try:
        answer = answer_type.model_validate(spoilt)
    except ValidationError:
        return
    assert check(answer) is not None


def test_every_kind_of_question_can_be_answered_wrongly():
    assert set(SPOILT) == {*RULES, "object-poses"}
