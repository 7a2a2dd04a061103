import numpy as np
import pytest
from pydantic import ValidationError

from coral.contact.cost_program import CostError
from coral.contact.plan.contact_regions import ObjectRegions, Region, RegionsAnswer
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, compile_plan, condition, make_strategy

CODE = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"


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
        compile_plan(plan, scene("pick-box").world.schema)
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

    def guides(regions, **more):
        made = make_strategy("x", plan, regions, one.world.schema, one.sizes, **more)
        return [len(stage.guides) for stage in made.stages]

    assert guides(None) == [0, 0]
    assert guides(regions) == [2, 2]
    assert guides(regions, candidates=[np.zeros((0, 3)), np.zeros((1, 3))]) == [2, 1]
    way = make_strategy("x", plan, regions, one.world.schema, one.sizes).stages[0].guides[-1]
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
