import dataclasses

import numpy as np
import pytest
from pydantic import ValidationError

from coral.contact.cost_program import CostError
from coral.contact.plan.contact_regions import ObjectRegions, Region, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, compile_stage, condition, make_strategy
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.scene_text import scene_text, told_in_scene

CODE = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"
OFF = "def state_cost(self):\n    return {'off': norm(self.ee_pos - self.box_pos)}"
STAGES = [
    {
        "name": "a",
        "code": OFF,
        "done": "self.box_pos[2] < 9",
        "next": {"b": "self.box_seen"},
        "toward": "self.box_pos",
    },
    {"name": "b", "code": "def state_cost(self):\n    return {'up': 1.0 - self.ee_pos[2]}", "done": "self.time < 9"},
    {"name": "c", "code": OFF},
]


def stage(**more):
    return StageAnswer.model_validate({"name": "a", "code": CODE, **more})


def test_a_plan_is_one_function_or_stages():
    with pytest.raises(ValueError, match="either"):
        PlanAnswer()
    with pytest.raises(ValueError, match="either"):
        PlanAnswer(code=CODE, stages=[stage()])
    assert PlanAnswer(code="x").names == ["task"]


def test_the_first_stage_of_a_cut_off_reply_does_not_pass_for_a_plan():
    with pytest.raises(ValidationError, match="this is one stage"):
        PlanAnswer.model_validate({"name": "reach", "code": CODE})


def test_the_text_of_a_plan_has_each_stage_with_its_conditions():
    plan = PlanAnswer(stages=[stage(done="self.time > 1"), stage(name="b", back_to="a", lost="self.time > 2")])
    assert plan.text() == (
        f"# stage 'a'\n#   done: self.time > 1\n{CODE}\n\n# stage 'b'\n#   next 'a' when: self.time > 2\n{CODE}"
    )
    assert PlanAnswer(code=CODE).text() == CODE


def test_a_condition_may_have_comments_and_several_lines():
    assert condition("""
        self.time > 1  # late
        and self.box_pos[2] > 0.1
    """).endswith("return 1.0 * (self.time > 1 and self.box_pos[2] > 0.1)")


@pytest.mark.parametrize(
    ("field", "given"), [("done", "self.box_pos["), ("next.b", {"b": "self.box_pos["}), ("toward", "self.box_pos[")]
)
def test_a_program_that_does_not_compile_is_named_by_its_field(scene, field, given):
    plan = PlanAnswer(stages=[stage(**{field.partition(".")[0]: given})])
    with pytest.raises(CostError) as told:
        compile_stage(plan.stages[0], scene("pick-box").world.schema)
    assert str(told.value).startswith(f"`{field}`: not Python")  # and not a line of the program made of it


def test_the_conditions_of_a_stage_are_tested_in_the_present_state(scene):
    one = scene("pick-box")
    plan = PlanAnswer(
        stages=[
            stage(done="self.box_pos[2] < 1.0", back_to="b", lost="self.box_pos[2] > 1.0"),
            stage(name="b", stiffness=300.0, noise=0.5),
        ]
    )
    first, last = make_strategy("x", plan, None, one.world.schema, one.sizes).stages
    now = one.world.present(one.now)
    assert first.until(now)
    ((to, lost),) = first.next
    assert (to, lost(now)) == ("b", False)
    assert (last.until, last.next, last.stiffness_n_m, last.sigma) == (None, (), 300.0, 0.5)


def test_a_region_guides_the_stages_it_is_for(scene):
    one = scene("pick-box")
    plan = PlanAnswer(
        stages=[
            stage(done="self.time > 1", toward="self.ee_pos + np.array([0.0, 0.0, 0.1])", opening=0.03),
            stage(name="b"),
        ]
    )
    side = {"center": (0.0, 0.02, 0.0), "normal": (0.0, 1.0, 0.0)}
    regions = RegionsAnswer({"box": ObjectRegions(regions=[Region(**side, stage="b"), Region(**side)])})

    def made(regions, *counts):
        points = [np.zeros((count, 3)) for count in counts]
        return make_strategy("x", plan, regions, one.world.schema, one.sizes, candidates=points).stages

    assert [len(stage.guides) for stage in made(None)] == [0, 0]
    assert [len(stage.guides) for stage in made(regions, 1, 1)] == [2, 2]
    assert [len(stage.guides) for stage in made(regions, 0, 1)] == [2, 1]
    way = made(regions, 1, 1)[0].guides[-1]
    now = one.world.present(one.now)
    np.testing.assert_allclose(way.points(now), [one.now.tool.position + np.array([0.0, 0.0, 0.1])])
    assert way.opening_m == 0.03


def test_the_hand_keeps_off_table_and_fixtures_unless_the_cost_says_what_to_do_there(scene):
    one = scene("flip-wall")
    press = "def state_cost(self):\n    return abs(norm(self.wall_hand_force) - 5.0)"
    inner = "def state_cost(self):\n    return 1.0 * self.box_wall_contact + self.box_hand_contact + self.ee_pos[0]"
    named = "def state_cost(self):\n    # self.wall_hand_force is no concern here\n    return self.ee_pos[0]"
    programs = (press, inner, named)
    plan = PlanAnswer(stages=[stage(name=f"s{k}", code=code, done="self.time > 1") for k, code in enumerate(programs)])
    made = make_strategy("x", plan, None, one.world.schema, one.sizes)
    assert [each.keeps_off for each in made.stages] == [False, True, True]


@pytest.fixture
def followed(scene):
    one = scene("pick-box")
    stages = make_strategy("x", PlanAnswer.model_validate({"stages": STAGES}), None, one.world.schema, one.sizes).stages
    hidden = dataclasses.replace(one.now, unseen=frozenset({"box"}))
    return stages, one.world.present(one.now), one.world.present(hidden)


def test_a_cost_that_reads_it_keeps_the_hand_where_it_is(followed):
    (first, other, _), seen, hidden = followed
    assert list(first.cost(seen)) == ["off"]
    assert list(first.cost(hidden)) == ["wait for box"]
    assert list(other.cost(hidden)) == ["up"]


def test_a_condition_that_reads_it_does_not_hold_but_one_may_ask_whether_it_was_seen(followed):
    (first, other, _), seen, hidden = followed
    assert (first.until(seen), first.until(hidden), other.until(hidden)) == (True, False, True)
    assert (first.next[0][1](seen), first.next[0][1](hidden)) == (True, False)


def test_the_scene_says_what_was_not_seen_and_only_then_tells_of_the_quantity(scene):
    one = scene("pick-box")
    hidden = dataclasses.replace(one.now, unseen=frozenset({"box"}))
    facts, unknown = scene_facts(one.trial, one.now), scene_facts(one.trial, hidden)
    assert "box_seen" in told_in_scene(facts)
    assert "box_seen" not in told_in_scene(unknown)
    assert "Not seen yet" not in scene_text(facts)
    low, high = one.trial.task.objects[0].x
    assert f"Not seen yet, its pose a guess: box (somewhere in x {low:g} to {high:g}, y " in scene_text(unknown)


def test_an_object_lost_on_the_way_is_not_seen_and_only_what_asks_for_that_waits(scene, followed):
    one, (stages, seen, _) = scene("pick-box"), followed
    now = dataclasses.replace(one.now, lost=frozenset({"box"}))
    lost = one.world.present(now)
    assert (float(seen.box_seen.flat[0]), float(lost.box_seen.flat[0])) == (1.0, 0.0)
    # The hand itself hides what it reaches for: costs and conditions go on with the pose last seen.
    assert list(stages[0].cost(lost)) == ["off"]
    assert (stages[0].until(lost), stages[0].next[0][1](lost)) == (True, False)
    facts = scene_facts(one.trial, now)
    assert "Out of sight now, its pose the last one seen: box." in scene_text(facts)
    assert "box_seen" not in told_in_scene(facts)


def test_nothing_is_told_of_where_an_object_may_be_that_another_carries(scene):
    one = scene("pick-box")
    on_top = one.trial.task.objects[0].model_copy(update={"stands_on": "crate"})
    task = one.trial.task.model_copy(update={"objects": (on_top,)})
    hidden = dataclasses.replace(one.now, unseen=frozenset({"box"}))
    facts = scene_facts(dataclasses.replace(one.trial, task=task), hidden)
    assert "Not seen yet, its pose a guess: box. " in scene_text(facts)


def test_nothing_leads_to_its_guessed_place(scene):
    one = scene("pick-box")
    plan = PlanAnswer.model_validate({"stages": STAGES})
    first = make_strategy("x", plan, RegionsAnswer({}), one.world.schema, one.sizes).stages[0]
    hidden = one.world.present(dataclasses.replace(one.now, unseen=frozenset({"box"})))
    assert np.allclose(first.guides[0].points(hidden), hidden.ee_pos[0])
