from dataclasses import replace

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.plan.contact_regions import tool_quaternion
from coral.contact.plan.cost_plan import make_strategy
from coral.contact.plan.plan_check import verify_plan
from coral.contact.plan.region_validation import verify_regions
from coral.contact.rules.adjustments import adjustment_after
from coral.contact.rules.composition import NoRule, compose
from coral.contact.rules.scene_reading import SkillAdjustment
from coral.contact.scene.geometry import multiply, rotate
from coral.contact.scene.task import Task
from coral.contact.scene.task_file import shipped_tasks


@pytest.mark.parametrize("task", shipped_tasks())
def test_every_shipped_task_gets_a_plan_that_passes_the_checks(scene, task):
    one = scene(task)
    made = compose(one.facts)
    assert verify_plan(made.plan, one.world.schema, one.samples) is None
    assert verify_regions(made.regions, one.facts, made.plan.names) is None
    strategy = make_strategy("x", made.plan, made.regions, one.world.schema, one.sizes)
    assert strategy.stages[0].guides


def new_task(conditions, size=(0.05, 0.05, 0.07), **more):
    return Task.model_validate(
        {
            "name": "new",
            "title": "New",
            "instruction": "Do it.",
            "time_limit_s": 20,
            "objects": [
                {"name": "brick", "parts": [{"size": list(size)}], "mass_kg": 0.2, "friction": 0.5, "x": 0, "y": 0}
            ],
            "places": {"there": [0.1, 0.15, 0.0]},
            "success": {"conditions": conditions},
            **more,
        }
    )


def names(one):
    return compose(one.facts).plan.names


def test_between_two_objects_the_hand_first_gets_clear_of_the_one_that_it_let_go(scene):
    goals = [
        {"kind": "at", "object": name, "place": place, "tolerance_m": 0.03}
        for name, place in (("brick", "there"), ("stone", "here"))
    ]
    other = {
        "name": "stone",
        "parts": [{"size": [0.04, 0.04, 0.06]}],
        "mass_kg": 0.2,
        "friction": 0.5,
        "x": -0.15,
        "y": 0,
    }
    task = new_task(goals, places={"there": [0.1, 0.15, 0.0], "here": [0.1, -0.15, 0.0]})
    first = task.objects[0].model_dump()
    one = scene(Task.model_validate({**task.model_dump(), "objects": [first, other]}))
    made = compose(one.facts)
    strategy = make_strategy("x", made.plan, None, one.world.schema, one.sizes)
    last = next(stage for stage in strategy.stages if stage.name == "retire")
    at = one.now.objects["brick"].position
    seen = [
        last.until(
            one.world.present(
                replace(one.now, opening_m=0.08, tool=replace(one.now.tool, position=at + np.array([0, 0, up])))
            )
        )
        for up in (0.01, 0.15)
    ]
    assert seen == [False, True]


def test_the_goal_and_the_size_choose_the_way(scene):
    to_there = {"kind": "at", "object": "brick", "place": "there", "tolerance_m": 0.03}
    assert names(scene(new_task([to_there])))[:2] == ["reach", "close"]
    assert names(scene(new_task([to_there], size=(0.12, 0.12, 0.05)))) == ["reach", "push", "draw back"]
    tipped = {"kind": "flipped", "object": "brick"}
    assert names(scene(new_task([tipped], size=(0.05, 0.09, 0.12)))) == ["reach", "tip", "draw back"]


def test_a_new_task_with_two_objects_is_done_one_after_the_other(scene):
    task = new_task(
        [{"kind": "at", "object": name, "place": "there", "tolerance_m": 0.1} for name in ("brick", "cup")],
        objects=[
            {"name": name, "parts": [{"size": [0.04, 0.04, 0.06]}], "mass_kg": 0.2, "friction": 0.5, "x": 0, "y": y}
            for name, y in (("brick", 0.0), ("cup", -0.2))
        ],
    )
    one = scene(task)
    made = compose(one.facts)
    assert "reach" in made.plan.names
    assert "reach 2" in made.plan.names
    assert verify_plan(made.plan, one.world.schema, one.samples) is None


def test_what_no_rule_knows_is_said(scene):
    one = scene(new_task([{"kind": "lifted", "object": "brick", "height_m": 0.1}], size=(0.2, 0.2, 0.2)))
    with pytest.raises(NoRule, match="too wide to grasp"):
        compose(one.facts)


def test_a_board_whose_frame_is_not_in_its_middle_is_pushed_at_its_rear_face(scene):
    one = scene("push-pick-board")
    region = next(region for _, region in compose(one.facts).regions.each() if region.approach == "push")
    assert region.center[1] == pytest.approx(-0.14)


def test_repairs_change_the_plan(scene):
    one = scene("pick-box")
    assert compose(one.facts).plan != compose(one.facts, adjustment_after(["slipped"])).plan


def test_what_is_wider_than_the_fingers_are_long_is_pinched_near_its_rim(scene):
    facts = scene("push-pick-board").facts
    entry = next(region for _, region in compose(facts).regions.each() if region.stage == "insert")
    assert entry.center[0] == pytest.approx(-0.045)


def test_a_board_that_overhangs_already_is_not_pushed_again(scene):
    one = scene("push-pick-board")
    plan = compose(one.facts).plan
    edge = float(one.facts["table"]["y"][1])
    body = one.now.objects["board"]
    moved = replace(body, position=np.array([body.position[0], edge - 0.14, body.position[2]]))
    there = replace(one.now, objects={"board": moved})
    strategy = make_strategy("x", plan, None, one.world.schema, one.sizes)
    progress = Progress(strategy)
    assert progress.update(one.world.present(there))
    assert progress.update(one.world.present(there))
    assert progress.stage.name == "rise"


def test_a_repair_of_the_way_in_takes_another_slant_and_goes_deeper_when_it_slipped(scene):
    facts = scene("push-pick-board").facts
    made = [compose(facts, SkillAdjustment(turn=turn)) for turn in range(3)]
    ways = {region.normal for one in made for _, region in one.regions.each() if region.stage == "insert"}
    assert len(ways) == 3
    assert [verify_regions(one.regions, facts, one.plan.names) for one in made] == [None] * 3
    first, again = (
        compose(facts, adjustment).plan.stages[5].code
        for adjustment in (SkillAdjustment(), adjustment_after(["slipped"]))
    )
    assert first != again


def test_a_steady_force_is_pushed_with_a_hand_so_soft_that_it_cannot_push_much_harder(scene):
    stages = compose(scene("push-force").facts).plan.stages
    assert [stage.name for stage in stages] == ["reach", "push", "draw back"]
    assert [stage.stiffness * 0.06 for stage in stages[1:]] == pytest.approx([9.0, 9.0])


def test_of_two_orientations_that_push_alike_the_one_is_taken_that_can_go_on_along_the_edge(scene):
    one = scene("push-pick-board")
    made = compose(one.facts)
    push = make_strategy("x", made.plan, None, one.world.schema, one.sizes).stages[1]

    def square(opening):
        turn = tool_quaternion(np.array([0.0, 0.0, -1.0]), np.array([opening, 0.0, 0.0]), one.now.tool.quaternion)
        sign = 1.0 if rotate(turn, [0.0, 1.0, 0.0])[0] * opening > 0 else -1.0
        held = turn if sign > 0 else multiply(turn, np.array([0.0, 0.0, 0.0, 1.0]))
        now = replace(one.now, tool=replace(one.now.tool, quaternion=held))
        return float(push.cost(one.world.present(now))["square"][0, 0])

    assert square(-1.0) < 0.2
    assert square(1.0) > 5.0
