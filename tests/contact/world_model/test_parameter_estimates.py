import json
import math

import pytest

from coral.advisor.question import Reply
from coral.advisor.rules import RuleAdvisor
from coral.contact.rules.estimates import estimate_parameters
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.scene_facts import interface_text, scene_facts
from coral.contact.world_model.parameter_estimates import ParameterEstimates, belief_prompt, verify_estimates
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg

SIZES = {"mug": (0.08, 0.08, 0.1)}


def answer(**objects):
    return ParameterEstimates.model_validate(
        {name: {"mass_kg": mass, "friction_coeff": friction} for name, (mass, friction) in objects.items()}
    )


def clutter():
    trial = sample_trial(load_task("pick-clutter"), 3)
    return trial, HandWorld(trial, HandWorldCfg()).reset()


def test_plausible_estimates_pass():
    assert verify_estimates(answer(mug=(0.3, 0.5)), SIZES) is None


@pytest.mark.parametrize(
    ("given", "code", "words"),
    [
        (answer(), "objects", "missing: mug"),
        (answer(mug=(0.3, 0.5), cup=(0.3, 0.5)), "objects", "not in the scene: cup"),
        (answer(mug=(-1.0, 0.5)), "bounds", "mass_kg of mug is -1"),
        (answer(mug=(0.3, 9.0)), "bounds", "between 0.02 and 2"),
        (answer(mug=(math.nan, 0.5)), "bounds", "nan"),
        (answer(mug=(15.0, 0.5)), "density", "kg/m3"),
    ],
)
def test_impossible_estimates_are_refused_with_a_reason(given, code, words):
    found = verify_estimates(given, SIZES)
    assert found.code == code
    assert words in found.reason


def test_facts_do_not_hold_the_true_parameters():
    trial, now = clutter()
    text = json.dumps(scene_facts(trial, now)) + json.dumps(belief_prompt(scene_facts(trial, now)))
    for item in trial.objects.values():
        assert not any(
            f"{value:.{digits}f}" in text
            for digits in (3, 4, 5)
            for value in (item.physical.mass_kg, item.physical.friction)
        )


class Mistaken:
    """Wrong at first; minds the reason."""

    name, reasons = "mistaken", ()

    async def answer(self, question, rejections):
        self.reasons = [rejection.reason for rejection in rejections]
        given = estimate_parameters(question.facts)
        if not rejections:
            given.root.popitem()
        return Reply(value=given, raw="")


def test_a_refused_answer_is_asked_for_again_with_the_reason():
    trial, now = clutter()
    facts = scene_facts(trial, now)
    advisor, heard = Mistaken(), []
    sizes = {name: item["size_m"] for name, item in facts["objects"].items()}
    asker = Asker(advisor, log=heard.append)
    outcome = asker.ask(
        "physical-parameters",
        ParameterEstimates,
        facts,
        belief_prompt(facts),
        lambda given: verify_estimates(given, sizes),
    )
    asker.close()
    assert outcome.answer is not None
    assert [attempt.verdict for attempt in heard] == ["rejected", "accepted"]
    assert "missing: " in advisor.reasons[0]
    assert asker.calls == 2


def test_an_advisor_without_the_rule_fails_by_name():
    asker = Asker(RuleAdvisor({}))
    facts = scene_facts(*clutter())
    outcome = asker.ask("physical-parameters", ParameterEstimates, facts, belief_prompt(facts), lambda given: None)
    asker.close()
    assert outcome.failure == "no-rule"


def test_interface_names_every_quantity():
    trial, _ = clutter()
    from coral.contact.control.quantities import task_schema_of

    schema = task_schema_of(trial.task)
    text = interface_text(schema)
    assert all(f"self.{name} " in text for name in schema)
