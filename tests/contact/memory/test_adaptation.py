"""A remembered plan, rewritten for a scene with other names and sizes."""

import json

import numpy as np
from experiences import experience

from coral.contact.memory.adaptation import adapt, renamed
from coral.contact.plan.plan_check import verify_plan
from coral.contact.plan.region_validation import verify_regions


def test_a_remembered_plan_fits_another_size(scene):
    one, other = scene("pick-box", 0), scene("pick-box", 2)
    plan, regions = adapt(experience(one), other.facts)
    assert verify_plan(plan, other.world.schema, other.samples) is None
    assert verify_regions(regions, other.facts, plan.names) is None


def test_regions_are_stretched_with_the_object_they_lie_on(scene):
    one = scene("pick-box")
    bigger = json.loads(json.dumps(one.facts))
    factors = np.array([1.2, 1.0, 0.5])
    bigger["objects"]["box"]["size_m"] = [
        a * b for a, b in zip(one.facts["objects"]["box"]["size_m"], factors, strict=True)
    ]
    held = experience(one)
    _, found = adapt(held, bigger)
    before = np.array([region.center for region in held.regions.root["box"].regions])
    after = np.array([region.center for region in found.root["box"].regions])
    assert np.abs(before).max() > 0.01
    np.testing.assert_allclose(after, before * factors, atol=1e-5)


def test_programs_and_regions_take_the_names_of_the_scene(scene):
    one = scene("pick-box")
    renamed_facts = json.loads(json.dumps(one.facts).replace('"box"', '"crate"'))
    held = experience(one)
    plan, regions = adapt(held, renamed_facts)
    assert list(regions.root) == ["crate"]
    text = plan.model_dump_json()
    assert "self.crate_" in text
    assert "self.box_" not in text
    assert "self.box_" in held.plan.model_dump_json()


def test_only_whole_names_of_quantities_are_renamed():
    program = "self.box_pos + self.boxer_pos + self.box_init_pos + box_pos"
    assert renamed(program, {"box": "can"}) == "self.can_pos + self.boxer_pos + self.can_init_pos + box_pos"
    assert renamed(program, {"box": "box"}) == program


def test_two_names_can_be_swapped():
    assert renamed("self.a_pos - self.b_pos", {"a": "b", "b": "a"}) == "self.b_pos - self.a_pos"


def test_the_longer_of_two_names_is_renamed_first():
    names = {"box": "can", "box_lid": "cap"}
    assert renamed("self.box_lid_pos - self.box_pos", names) == "self.cap_pos - self.can_pos"
