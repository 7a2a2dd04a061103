"""Goals that are neither a place nor a height: inside a region, resting on something; and what nothing serves."""

import numpy as np
import pytest

from coral.contact.cost_program import CostProgram
from coral.contact.plan.plan_check import verify_plan
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.touchable_points import Scenery
from coral.contact.rules.composition import NoRule, compose
from coral.contact.rules.goals import goal_words, movement_goals
from coral.contact.rules.outcome_cost import outcome_plan
from coral.contact.scene.task import Task

TRAY = [{"name": "tray_floor", "size": [0.14, 0.14, 0.01], "position": [0.1, 0.16, 0.005]}] + [
    {"name": f"tray_side{k}", "size": size, "position": [0.1 + x, 0.16 + y, 0.03]}
    for k, (x, y, size) in enumerate(
        [
            (0.07, 0, [0.01, 0.15, 0.06]),
            (-0.07, 0, [0.01, 0.15, 0.06]),
            (0, 0.07, [0.15, 0.01, 0.06]),
            (0, -0.07, [0.15, 0.01, 0.06]),
        ]
    )
]
INTO_TRAY = {"kind": "inside", "object": "brick", "low": [0.04, 0.1, 0.0], "high": [0.16, 0.22, 0.1]}
SHELF = [{"name": "shelf", "size": [0.2, 0.15, 0.08], "position": [0.1, 0.2, 0.04]}]
ONTO_SHELF = {"kind": "resting", "object": "brick", "thing": "shelf"}
PUT = ["reach", "close", "raise", "carry", "lower", "release", "retire"]


def task(*conditions, size=(0.05, 0.05, 0.07), **more):
    return Task.model_validate(
        {
            "name": "new",
            "title": "New",
            "instruction": "Do it.",
            "time_limit_s": 20,
            "objects": [
                {"name": "brick", "parts": [{"size": list(size)}], "mass_kg": 0.2, "friction": 0.6, "x": 0, "y": -0.05}
            ],
            "places": {"there": [0.1, 0.15, 0.0]},
            "success": {"conditions": list(conditions)},
            **more,
        }
    )


def check(one):
    """The plan, once it has passed the checks that a model's would have to pass."""
    made = compose(one.facts)
    assert verify_plan(made.plan, one.world.schema, one.samples) is None
    assert verify_regions(made.regions, one.facts, made.plan.names, None, Scenery.of(one.trial)) is None
    return made.plan


def value(one, plan, stage, term):
    """A term of a stage's cost in the state now."""
    code = next(answer.code for answer in plan.stages if answer.name == stage)
    return float(np.asarray(CostProgram(code, one.world.schema, stage)(one.world.present(one.now))[term]).flat[0])


def test_inside_a_region_is_carried_over_its_rim_and_let_go_in_it(scene):
    one = scene(task(INTO_TRAY, {"kind": "released", "object": "brick"}, fixtures=TRAY))
    plan = check(one)
    assert plan.names == PUT
    raised = next(stage for stage in plan.stages if stage.name == "raise")
    # over the rim at 6 cm goes the brick's lower side, 3.5 cm below its middle
    assert float(raised.done.split("> ")[1]) > 0.06 + 0.035
    here = one.now.objects["brick"].position
    aside = float(np.linalg.norm(here[:2] - [0.1, 0.16]))
    assert value(one, plan, "carry", "carry") == pytest.approx(
        10 * (aside + abs(here[2] - float(raised.done.split("> ")[1]) - 0.03)), rel=1e-2
    )


def test_several_objects_are_put_side_by_side_into_one_region(scene):
    objects = [
        {"name": name, "parts": [{"size": [0.04, 0.04, 0.06]}], "mass_kg": 0.2, "friction": 0.6, "x": 0, "y": y}
        for name, y in (("brick", -0.05), ("can", -0.15))
    ]
    wide = {"low": [0.0, 0.1, 0.0], "high": [0.2, 0.22, 0.1]}
    one = scene(task({**INTO_TRAY, **wide}, {**INTO_TRAY, **wide, "object": "can"}, objects=objects))
    codes = [stage.code for stage in check(one).stages if stage.name.startswith("lower")]
    assert "np.array([0.05, 0.16, 0])" in codes[0]
    assert "np.array([0.15, 0.16, 0])" in codes[1]


def test_the_palm_stays_above_the_rim(scene):
    low = scene(task({**INTO_TRAY, "high": [0.16, 0.22, 0.1]}, fixtures=TRAY, size=(0.04, 0.04, 0.03)))
    lower = next(stage for stage in check(low).stages if stage.name == "lower")
    # the tool is at most 37 mm ahead of the palm: the brick, held in its middle, falls the rest
    assert float(lower.done.split("< ")[1]) > 0.06 - 0.037


def test_resting_on_something_is_put_on_its_top(scene):
    one = scene(task(ONTO_SHELF, {"kind": "released", "object": "brick"}, fixtures=SHELF))
    plan = check(one)
    assert plan.names == PUT
    lower = next(stage for stage in plan.stages if stage.name == "lower")
    assert float(lower.done.split("< ")[1]) == pytest.approx(0.08 + 0.035 + 0.006, abs=0.002)


def test_one_object_is_stacked_on_another_wherever_that_is(scene):
    objects = [
        {"name": name, "parts": [{"size": [0.05, 0.05, 0.06]}], "mass_kg": 0.2, "friction": 0.6, "x": 0, "y": y}
        for name, y in (("brick", -0.1), ("base", 0.1))
    ]
    one = scene(task({**ONTO_SHELF, "thing": "base"}, objects=objects))
    plan = check(one)
    carry = next(stage for stage in plan.stages if stage.name == "carry")
    assert "self.base_pos" in carry.code
    lower = next(stage for stage in plan.stages if stage.name == "lower")
    assert float(lower.done.split("< ")[1]) == pytest.approx(0.06 + 0.03 + 0.006, abs=0.002)


@pytest.mark.parametrize(
    ("conditions", "size", "fixtures", "words"),
    [
        ([INTO_TRAY], (0.12, 0.12, 0.05), TRAY, r"too wide.*inside \[0.04, 0.1, 0.0\] to \[0.16, 0.22, 0.1\]"),
        ([ONTO_SHELF], (0.12, 0.12, 0.05), SHELF, "too wide.*resting on shelf"),
        (
            [{**INTO_TRAY, "low": [0.04, 0.1, 0.2], "high": [0.16, 0.22, 0.3]}],
            (0.05, 0.05, 0.07),
            TRAY,
            "comes to rest at a height of 0.045 m: inside",
        ),
        (
            [{**INTO_TRAY, "low": [1.0, 1.0, 0.0], "high": [1.2, 1.2, 0.2]}],
            (0.05, 0.05, 0.07),
            [],
            "nothing is there for the brick to lie on: inside",
        ),
        (
            [INTO_TRAY, {"kind": "lifted", "object": "brick", "height_m": 0.1}],
            (0.05, 0.05, 0.07),
            TRAY,
            "can be held, but no rule does besides: inside",
        ),
        (
            [
                {"kind": "flipped", "object": "brick"},
                {"kind": "at", "object": "brick", "place": "there", "tolerance_m": 0.1},
            ],
            (0.05, 0.05, 0.07),
            [],
            "can be turned over, but no rule does besides: at there",
        ),
        ([{"kind": "flipped", "object": "brick", "degrees": 180}], (0.05, 0.05, 0.07), [], "flipped by 180 degrees"),
        (
            [{"kind": "touched-while-turning", "object": "brick", "thing": "shelf"}],
            (0.05, 0.05, 0.07),
            SHELF,
            "touched-while-turning by shelf",
        ),
        (
            [{"kind": "at", "object": "brick", "place": "there", "tolerance_m": 0.1, "axes": axis} for axis in "xy"],
            (0.05, 0.05, 0.07),
            [],
            "two things of one kind.*at there",
        ),
        (
            [{"kind": "resting", "object": "brick"}, {"kind": "upright", "object": "brick"}],
            (0.05, 0.05, 0.07),
            [],
            "no goal asks for anything to be moved: resting on table, upright",
        ),
    ],
)
def test_what_cannot_be_composed_is_said_with_the_goal(scene, conditions, size, fixtures, words):
    one = scene(task(*conditions, size=size, fixtures=fixtures))
    with pytest.raises(NoRule, match=words):
        compose(one.facts)


def test_what_lies_on_a_mat_in_a_plan_for_another_goal_asks_for_nothing_more(scene):
    one = scene("pick-clutter")
    asked = [goal for goal in one.facts["goals"] if goal["object"] == "can"]
    assert [goal["kind"] for goal in movement_goals(asked, one.facts)] == ["at"]


@pytest.mark.parametrize(
    ("condition", "fixtures", "term", "off"),
    [
        # the nearest point 2 cm within the region, 15 for each metre
        (INTO_TRAY, TRAY, "brick inside", 15 * np.hypot(0.06, 0.17)),
        (ONTO_SHELF, SHELF, "brick on shelf", 10 * (np.hypot(0.1, 0.25) + 0.08)),
    ],
)
def test_without_a_contact_strategy_the_cost_is_the_way_that_is_left(scene, condition, fixtures, term, off):
    one = scene(task(condition, fixtures=fixtures))
    plan = outcome_plan(one.facts)
    assert verify_plan(plan, one.world.schema, one.samples) is None
    found = CostProgram(plan.code, one.world.schema, "x")(one.world.present(one.now))
    assert float(np.asarray(found[term]).flat[0]) == pytest.approx(off, abs=0.02)


def test_every_kind_of_goal_has_a_name():
    assert goal_words({"kind": "lifted", "object": "brick", "height_m": 0.1}) == "lifted"


@pytest.mark.parametrize("axes", ["x", "y"])
def test_where_one_coordinate_of_a_place_counts_the_object_is_set_down_as_where_two_do(scene, axes):
    def heights(which):
        goal = {"kind": "at", "object": "brick", "place": "there", "tolerance_m": 0.02, "axes": which}
        one = scene(task(goal, {"kind": "released", "object": "brick"}, places={"there": [0.1, 0.16, 0.0]}))
        return [(stage.name, stage.done) for stage in check(one).stages if stage.name in ("raise", "lower")]

    assert heights(axes)[0] == heights("xy")[0]
    assert heights(axes)[1][1].split(" < ")[-1] == heights("xy")[1][1].split(" < ")[-1]


def test_limits_and_what_comes_with_another_goal_move_nothing_by_themselves(scene):
    lifted = {"kind": "lifted", "object": "brick", "height_m": 0.1}
    slid = {"kind": "slid", "object": "brick", "distance_m": 0.1}
    limits = [
        {"kind": "peak-force", "object": "brick", "newtons": 10.0},
        {"kind": "kept-level", "object": "brick"},
        {"kind": "never-touched", "object": "brick", "thing": "table"},
    ]
    facts = scene(task(lifted, slid, *limits)).facts
    assert [goal["kind"] for goal in movement_goals(facts["goals"], facts)] == ["lifted"]
    alone = scene(task(slid, *limits)).facts
    assert [goal["kind"] for goal in movement_goals(alone["goals"], alone)] == ["slid"]
