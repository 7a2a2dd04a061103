import numpy as np
import pytest
from recorded import RULES

from coral.advisor.question import Question
from coral.contact.mistakes.plausible import CONTACT_MISTAKES, PLANS
from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.plan.plan_check import judge_plan
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.touchable_points import Scenery
from coral.contact.world_model.parameter_estimates import ParameterEstimates

BY_NAME = {mistake.name: mistake for mistake in CONTACT_MISTAKES}
TYPES = {"cost-function": PlanAnswer, "contact-regions": RegionsAnswer, "physical-parameters": ParameterEstimates}


def wrong(one, name, kind, seed=0):
    """The right answer and the wrong one, as JSON."""
    right = RULES[kind](one.facts, ()).model_dump(mode="json")
    question = Question(kind=kind, prompt="", answer_type=TYPES[kind], facts=one.facts)
    return right, BY_NAME[name].err(question, right, (), np.random.default_rng(seed))


PLAN_MISTAKES = [mistake.name for mistake in CONTACT_MISTAKES if set(mistake.questions) == set(PLANS)]


@pytest.mark.parametrize("name", PLAN_MISTAKES)
def test_a_wrong_plan_reads_like_a_plan_and_some_pass_every_check(scene, name):
    one = scene("pick-clutter" if name == "wrong-object" else "flip-wall" if name == "wrong-side" else "pick-box")
    plans = []
    for seed in range(6):
        right, made = wrong(one, name, "cost-function", seed)
        assert made != right
        plans.append(PlanAnswer.model_validate(made))
    samples = one.samples
    assert any(judge_plan(plan, one.world.schema, samples).refusal is None for plan in plans)


def test_the_same_numbers_make_the_same_mistake(scene):
    one = scene("pick-box")
    assert wrong(one, "goal-off", "cost-function", 3) == wrong(one, "goal-off", "cost-function", 3)


def test_a_lift_before_a_grasp_lacks_the_stage_that_closes(scene):
    _, made = wrong(scene("pick-box"), "early-lift", "cost-function")
    assert [stage["name"] for stage in made["stages"]] == ["above", "lower", "lift", "hold"]


def test_one_object_alone_is_taken_for_no_other(scene):
    assert wrong(scene("pick-box"), "wrong-object", "cost-function")[1] is None


def test_masses_are_off_by_a_factor_of_ten_at_most_and_by_nothing_else(scene):
    one, factors = scene("pick-box"), []
    for seed in range(60):
        right, made = wrong(one, "parameters", "physical-parameters", seed)
        factors.append(made["box"]["mass_kg"] / right["box"]["mass_kg"])
    assert max(np.abs(np.log(factors))) <= np.log(10.0) + 1e-9
    assert 0.6 * np.log(10.0) / 2 < np.std(np.log(factors)) < np.log(10.0) / 2 * 1.2
    low, high = one.trial.task.object("box").mass_kg
    assert any(not low <= factor * right["box"]["mass_kg"] <= high for factor in factors)


def test_regions_on_another_face_pass_the_check(scene):
    one = scene("flip-wall")
    stages = [stage.name for stage in RULES["cost-function"](one.facts, ()).stages]
    right, made = wrong(one, "wrong-face", "contact-regions")
    before, after = (content["box"]["regions"][0]["normal"] for content in (right, made))
    assert np.dot(before, after) < 0.5
    assert np.linalg.norm(after) == pytest.approx(1.0)
    assert verify_regions(RegionsAnswer.model_validate(made), one.facts, stages, Scenery.of(one.trial)) is None


def test_every_mistake_is_of_a_question_that_is_asked():
    assert {kind for mistake in CONTACT_MISTAKES for kind in mistake.questions} <= set(RULES)
    assert len(BY_NAME) == len(CONTACT_MISTAKES)
