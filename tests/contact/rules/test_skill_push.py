import numpy as np
import pytest
from skills import Skill, bricks

from coral.contact.rules.scene_reading import SkillAdjustment
from coral.contact.rules.skill_push import HIGH, SOFT, abreast_opening, add_push, add_tip
from coral.contact.scene.task import Success

WIDE = [("brick", (0.12, 0.14, 0.05), (0.0, 0.0))]
TALL = [("brick", (0.05, 0.09, 0.12), (0.0, 0.0))]


def to(place="there", **more):
    return {"object": "brick", "kind": "at", "place": place, "point": None, "tolerance_m": 0.03, "axes": "xy", **more}


@pytest.mark.parametrize(
    ("place", "normal"),
    [
        ([0.2, 0.0, 0.0], (-1, 0, 0)),
        ([-0.2, 0.05, 0.0], (1, 0, 0)),
        ([0.0, 0.2, 0.0], (0, -1, 0)),
        ([0.05, -0.2, 0.0], (0, 1, 0)),
    ],
)
def test_the_face_behind_is_pushed(scene, place, normal):
    push = Skill(scene(bricks(*WIDE, places={"there": place})), add_push, to(), None)
    (region,) = push.regions
    assert region.normal == normal
    assert region.approach == "push"


def test_a_hand_that_may_not_press_hard_comes_back_clear_of_the_object(scene):
    """Beside the face that is pushed it may be near."""
    limit = {"conditions": [{"kind": "peak-force", "object": "brick", "newtons": 15.0}]}
    task = bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})
    free, gentle = (
        Skill(scene(one), add_push, to(), 6.0)
        for one in (task, task.model_copy(update={"success": Success.model_validate(limit)}))
    )
    assert "no blow" not in free.terms("reach")
    past, over, behind = ([0.08, 0.0, 0.03], [0.08, 0.0, 0.2], [-0.088, 0.0, 0.03])
    found = [gentle.terms("reach", ee_pos=at, ee_quat=[0.0, 1.0, 0.0, 0.0])["no blow"] for at in (past, over, behind)]
    assert found[0] > 7.0
    assert found[1] == 0.0
    assert found[2] < 2.0


def test_nearer_to_the_place_is_cheaper_until_it_is_there(scene):
    push = Skill(scene(bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})), add_push, to(), None)
    far, near, there = (np.array([x, 0.0, 0.025]) for x in (0.0, 0.1, 0.19))
    costs = [push.terms("push", brick_pos=at)["to the place"] for at in (far, near, there)]
    assert costs == sorted(costs, reverse=True)
    assert [push.done("push", brick_pos=at) for at in (far, near, there)] == [False, False, True]


def test_a_named_point_is_pushed_to_the_place(scene):
    task = bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})
    with_point = task.objects[0].model_copy(update={"points": {"corner": (0.05, 0.0, 0.0)}})
    one = scene(task.model_copy(update={"objects": (with_point,)}))
    push = Skill(one, add_push, to(point="corner"), None)
    assert push.done("push", brick_corner_pos=[0.2, 0.0, 0.0])
    assert not push.done("push", brick_pos=[0.2, 0.0, 0.0])


def test_a_steady_push_costs_least_at_the_force_that_is_asked_for(scene):
    push = Skill(scene(bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})), add_push, to(), 6.0)
    felt = {newtons: push.terms("push", brick_hand_force=[newtons, 0.0, 0.0])["force"] for newtons in (0, 6, 12)}
    assert felt[6] == pytest.approx(0.0, abs=1e-2)
    assert felt[0] == pytest.approx(felt[12], rel=0.05)
    aside = push.terms("push", brick_hand_force=[0.0, 6.0, 0.0])["force"]
    assert aside > felt[6] + 0.3


def test_the_hand_of_a_steady_push_pulls_hardly_harder_than_asked_and_draws_back_as_soft(scene):
    push = Skill(scene(bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})), add_push, to(), 6.0)
    assert [push.stage(name).stiffness * 0.06 for name in ("push", "draw back")] == pytest.approx([SOFT * 6.0] * 2)


def test_one_that_stops_short_is_pushed_again_and_one_that_is_there_is_left_alone(scene):
    push = Skill(scene(bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})), add_push, to(), 6.0)
    assert push.stage("draw back").back_to == "reach"
    free = Skill(scene(bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})), add_push, to(), None)
    assert free.stage("draw back").back_to == ""


def test_drawing_back_away_from_the_face_is_cheaper_than_staying(scene):
    push = Skill(scene(bricks(*WIDE, places={"there": [0.2, 0.0, 0.0]})), add_push, to(), None)
    at_face = np.array([-0.06 - 0.01, 0.0, 0.02])
    staying, away = (push.terms("draw back", ee_pos=at_face - [back, 0.0, 0.0])["away"] for back in (0.0, 0.05))
    assert away < staying - 0.4


def test_a_tall_brick_is_tipped_over_its_narrow_foot_and_after_a_repair_over_the_other(scene):
    one = scene(bricks(*TALL))
    first, again = (Skill(one, add_tip, adjustment=SkillAdjustment(turn=turn)) for turn in (0, 1))
    assert [int(np.argmax(np.abs(skill.regions[0].normal))) for skill in (first, again)] == [0, 1]
    assert first.regions[0].center[2] == pytest.approx(HIGH * 0.06, abs=1e-3)


def test_a_tip_is_done_when_the_top_has_gone_over(scene):
    tip = Skill(scene(bricks(*TALL)), add_tip)

    def leaning(degrees):
        half = np.radians(degrees) / 2
        return [np.cos(half), 0.0, np.sin(half), 0.0]

    assert [tip.done("tip", brick_quat=leaning(degrees)) for degrees in (0, 40, 60)] == [False, False, True]
    costs = [tip.terms("tip", brick_quat=leaning(degrees))["tip"] for degrees in (0, 30, 60)]
    assert costs == sorted(costs, reverse=True)


def test_two_fingers_side_by_side_stay_on_the_face_they_push():
    assert abreast_opening(0.1) == pytest.approx(0.04)
    assert abreast_opening(1.0) == 0.07
