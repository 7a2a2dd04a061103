import dataclasses

import pytest

from coral.advisor.question import Rejection
from coral.contact.rules.estimates import estimate_parameters
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.world_model.parameter_estimates import verify_estimates


def guess(name="a", **item):
    return estimate_parameters({"objects": {name: {"size_m": [0.1, 0.1, 0.1], **item}}}).root[name]


def test_every_object_is_guessed_by_what_it_is_called_and_by_nothing_that_the_task_states(scene):
    one = scene("pick-clutter", 3)
    trial, now = one.trial, one.now
    facts = scene_facts(trial, now)
    found = estimate_parameters(facts)
    assert verify_estimates(found, {name: item["size_m"] for name, item in facts["objects"].items()}) is None
    objects = tuple(
        item.model_copy(update={"mass_kg": (5.0, 6.0), "friction": (1.5, 1.6)}) for item in trial.task.objects
    )
    other = dataclasses.replace(trial, task=trial.task.model_copy(update={"objects": objects}))
    assert estimate_parameters(scene_facts(other, now)) == found


def test_what_was_refused_is_guessed_without_its_name():
    item = {"size_m": [0.1, 0.1, 0.1], "label": "steel block"}
    found = estimate_parameters({"objects": {"a": item}}, [Rejection(code="density", reason="too dense")])
    assert found.root["a"].mass_kg == pytest.approx(0.5)


def test_the_mass_is_that_of_the_solid_share_of_the_box():
    assert guess(label="wooden block").mass_kg == pytest.approx(0.65)
    assert guess(label="wooden block", solid_share=0.2).mass_kg == pytest.approx(0.13)
    assert guess(label="wooden block", size_m=[0.2, 0.1, 0.05]).mass_kg == pytest.approx(0.65)


@pytest.mark.parametrize(
    ("name", "label"), [("a", "Steel block"), ("a", "stainless-steel block"), ("steel_block", ""), ("steel", "thing")]
)
def test_the_material_is_found_in_the_label_or_else_in_the_name(name, label):
    assert guess(name, label=label).mass_kg == pytest.approx(7.0)


def test_of_two_materials_the_first_one_named_counts():
    assert guess(label="cardboard box of steel").mass_kg == pytest.approx(0.25)
