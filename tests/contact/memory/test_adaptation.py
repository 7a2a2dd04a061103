"""A remembered plan, rewritten for a scene with other names and sizes."""

import json

import numpy as np
from experiences import experience

from coral.contact.memory.adaptation import adapt, renamed
from coral.contact.memory.goal_match import match_goals
from coral.contact.memory.memory import RememberedPlan
from coral.contact.plan.plan_check import judge_plan
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.touchable_points import Scenery


def adapted(held, facts):
    first, *_ = adapt(held, facts, match_goals(held.goals, facts["goals"]))
    return first.plan, first.regions


def changed(facts, **texts):
    text = json.dumps(facts)
    for old, new in texts.items():
        text = text.replace(f'"{old}"', f'"{new}"')
    return json.loads(text)


def test_a_remembered_plan_fits_another_size(scene):
    one, other = scene("pick-box", 0), scene("pick-box", 2)
    plan, regions = adapted(experience(one), other.facts)
    assert judge_plan(plan, other.world.schema, other.samples).refusal is None
    assert verify_regions(regions, other.facts, plan.names, Scenery.of(other.trial)) is None


def test_regions_are_stretched_with_the_object_they_lie_on(scene):
    one = scene("pick-box")
    bigger = changed(one.facts)
    factors = np.array([1.2, 1.0, 0.5])
    bigger["objects"]["box"]["size_m"] = [
        a * b for a, b in zip(one.facts["objects"]["box"]["size_m"], factors, strict=True)
    ]
    held = experience(one)
    _, found = adapted(held, bigger)
    before = np.array([region.center for region in held.regions.root["box"].regions])
    after = np.array([region.center for region in found.root["box"].regions])
    assert np.abs(before).max() > 0.01
    np.testing.assert_allclose(after, before * factors, atol=1e-5)


def test_programs_and_regions_take_the_names_of_the_scene(scene):
    one = scene("pick-box")
    held = experience(one)
    plan, regions = adapted(held, changed(one.facts, box="crate"))
    assert list(regions.root) == ["crate"]
    text = plan.model_dump_json()
    assert "self.crate_" in text
    assert "self.box_" not in text
    assert "self.box_" in held.plan.model_dump_json()


def test_its_repairs_take_the_names_too(scene):
    one = scene("pick-box")
    held = experience(one)
    held = held.model_copy(update={"then": [RememberedPlan(plan=held.plan, regions=held.regions)]})
    goals = changed(one.facts, box="crate")
    first, second = adapt(held, goals, match_goals(held.goals, goals["goals"]))
    assert second == first != held.then[0]


def test_a_neighbour_that_is_not_here_is_not_read(scene):
    one = scene("pick-clutter")
    held = experience(one).model_copy(update={"beliefs": dict.fromkeys(one.facts["objects"], (0.2, 0.5))})
    alone = changed(one.facts)
    for name in ("carton", "block", "tin"):
        del alone["objects"][name]
    text = adapted(held, alone)[0].text()
    assert "self.can_pos" in text
    assert "'over': 12.0 * norm(d[:2])" in text
    for unread in ("carton", "block", "tin_", "'others'", "'gap'", "'can gap'"):
        assert unread not in text
        assert unread in held.plan.text()


def test_a_neighbour_of_another_name_takes_the_place_of_one(scene):
    one = scene("pick-clutter")
    held = experience(one).model_copy(update={"beliefs": dict.fromkeys(one.facts["objects"], (0.2, 0.5))})
    text = adapted(held, changed(one.facts, tin="jar"))[0].text()
    assert "norm(self.carton_vel) + norm(self.block_vel) + norm(self.jar_vel)" in text
    assert "self.can_jar_clearance" in text
    assert "tin_" not in text


def test_only_whole_names_of_quantities_are_renamed():
    program = "self.box_pos + self.boxer_pos + self.box_init_pos + box_pos"
    assert renamed(program, {"box": "can"}) == "self.can_pos + self.boxer_pos + self.can_init_pos + box_pos"
    assert renamed(program, {"box": "box"}) == program


def test_two_names_can_be_swapped():
    assert renamed("self.a_pos - self.b_pos", {"a": "b", "b": "a"}) == "self.b_pos - self.a_pos"


def test_the_longer_of_two_names_is_renamed_first():
    names = {"box": "can", "box_lid": "cap"}
    assert renamed("self.box_lid_pos - self.box_pos", names) == "self.cap_pos - self.can_pos"


def test_what_a_thing_touches_is_renamed_too():
    names = {"box": "can", "wall": "barrier"}
    program = "self.box_wall_contact * self.wall_pos[0] + self.box_left_contact"
    assert renamed(program, names) == "self.can_barrier_contact * self.barrier_pos[0] + self.can_left_contact"
