import pytest
from written_facts import brick, written

from coral.advisor.question import AdvisorUnavailable, Rejection
from coral.contact.plan.region_validation import verify_regions
from coral.contact.rules.adjustments import adjustment_after
from coral.contact.rules.answers import RULES
from coral.contact.rules.composition import compose
from coral.contact.rules.estimates import estimate_parameters
from coral.contact.rules.outcome_cost import outcome_plan

FITTED = {"object": "box", "mass_kg": 0.4, "friction": 0.3}
REFUSED = Rejection(code="constant", reason="the cost is the same for every sampled rollout")
LEFT_ALONE = written({"brick": brick()}, goals=[{"kind": "undisturbed", "object": "brick", "tolerance_m": 0.01}])


def test_a_repair_claims_no_change_that_its_rules_do_not_make(scene):
    facts = scene("flip-wall").facts
    repaired = RULES["cost-repair"]({**facts, "diagnoses": ["not-reached"]}, ())
    assert repaired.stages == compose(facts).plan.stages
    assert "tries the same again" in repaired.explanation


def test_without_a_contact_strategy_a_repair_claims_no_change_either(scene):
    facts = {**scene("pick-box").facts, "contact_strategy": False, "diagnoses": ["not-reached"]}
    assert "tries the same again" in RULES["cost-repair"](facts, ()).explanation


def test_the_rules_leave_out_a_place_that_cannot_be_touched_and_keep_the_others(scene):
    one = scene("push-pick-board")
    asked = {**one.facts, "stages": []}
    whole = RULES["contact-regions"](asked, ())
    rear = one.facts["objects"]["board"]["pose"][1] - 0.14
    refusal = verify_regions(
        whole,
        {
            **one.facts,
            "fixtures": {"wall": {"position": [0, rear - 0.05, 0.1], "size_m": [0.6, 0.1, 0.2], "yaw_deg": 0.0}},
        },
        compose(one.facts).plan.names,
    )
    assert refusal.code == "buried"
    again = RULES["contact-regions"](asked, [refusal])
    assert again.each() == [pair for pair in whole.each() if pair[1].stage != "reach"]


def test_the_rules_answer_with_the_cost_of_outcomes_where_there_is_to_be_no_contact_strategy(scene):
    facts = scene("flip-wall").facts
    asked = {**facts, "contact_strategy": False}
    plan = outcome_plan(facts)
    repaired = RULES["cost-repair"]({**asked, "diagnoses": ["no-progress"]}, ())
    assert RULES["cost-function"](asked, ()) == plan
    assert repaired.model_copy(update={"explanation": plan.explanation}) == plan
    assert RULES["contact-regions"](asked, ()).root == {}


def test_a_refused_plan_is_composed_anew_with_the_next_grasp(scene):
    facts = scene("pick-box").facts
    assert RULES["cost-function"](facts, [REFUSED]) == compose(facts, adjustment_after(["no-progress"])).plan
    assert RULES["cost-function"](facts, [REFUSED]) != RULES["cost-function"](facts, ())


def test_regions_for_stages_of_another_author_are_for_every_stage(scene):
    facts = scene("pick-box").facts
    own = RULES["contact-regions"](facts, ())
    same = RULES["contact-regions"]({**facts, "stages": compose(facts).plan.names}, ())
    others = RULES["contact-regions"]({**facts, "stages": ["approach", "grip"]}, ())
    assert same == own
    assert {region.stage for _, region in own.each()} == {"reach"}
    assert {region.stage for _, region in others.each()} == {""}


def test_a_repair_says_why_the_plan_failed_and_what_it_changes(scene):
    facts = {**scene("pick-box").facts, "diagnoses": ["slipped"]}
    repaired = RULES["cost-repair"](facts, ())
    assert repaired.stages == compose(facts, adjustment_after(["slipped"])).plan.stages
    assert repaired.explanation.startswith(
        "The plan before failed because contact was made and lost again and again. The new one presses"
    )


def test_a_better_fit_is_answered_and_a_worse_one_is_not():
    (found,) = RULES["parameter-repair"]({"fitted": {**FITTED, "better": True}}, ()).objects
    assert (found.label, found.mass, found.friction) == ("box", 0.4, 0.3)
    with pytest.raises(AdvisorUnavailable) as gone:
        RULES["parameter-repair"]({"fitted": {**FITTED, "better": False}}, ())
    assert (gone.value.code, gone.value.final) == ("no-better-fit", True)


@pytest.mark.parametrize("contact_strategy", [True, False])
def test_what_no_rule_serves_is_not_asked_again(contact_strategy):
    with pytest.raises(AdvisorUnavailable, match="no goal asks for anything to be moved: undisturbed") as gone:
        RULES["cost-function"]({**LEFT_ALONE, "contact_strategy": contact_strategy}, ())
    assert (gone.value.code, gone.value.final) == ("no-rule", True)


def test_one_answer_to_everything_estimates_what_is_unknown_and_keeps_what_is_believed(scene):
    known = scene("pick-box").facts
    unknown = {
        **known,
        "objects": {
            name: {key: value for key, value in item.items() if key not in ("mass_kg", "friction")}
            for name, item in known["objects"].items()
        },
    }
    kept, guessed = (RULES["unified"](facts, ()) for facts in (known, unknown))
    assert kept.parameters["box"].mass_kg == known["objects"]["box"]["mass_kg"]
    assert kept.parameters["box"].friction_coeff == known["objects"]["box"]["friction"]
    assert guessed.parameters == estimate_parameters(unknown).root != kept.parameters
    assert kept.stages == compose(known).plan.stages
    assert kept.regions == compose(known).regions.root
