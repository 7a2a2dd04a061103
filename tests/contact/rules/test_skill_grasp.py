import numpy as np
import pytest
from skills import Skill, bricks

from coral.contact.rules.placement import Placement
from coral.contact.rules.scene_reading import SkillAdjustment
from coral.contact.rules.skill_grasp import add_grasp, add_lift, add_place, add_release

ALONE = [("brick", (0.05, 0.06, 0.07), (0.0, 0.0))]


def test_the_fingers_close_across_the_narrower_side_and_after_a_repair_across_the_other(scene):
    one = scene(bricks(*ALONE))
    closing = [Skill(one, add_grasp, adjustment=SkillAdjustment(turn=turn)).regions[0].closing for turn in range(3)]
    assert closing == [0, 1, 0]


def test_beside_a_neighbour_they_close_across_the_side_that_is_free(scene):
    wall = ("can", (0.04, 0.04, 0.12), (0.085, 0.0))
    assert Skill(scene(bricks(*ALONE, wall)), add_grasp).regions[0].closing == 1
    low = ("can", (0.04, 0.04, 0.02), (0.085, 0.0))
    assert Skill(scene(bricks(*ALONE, low)), add_grasp).regions[0].closing == 0


def test_the_reach_is_done_where_the_hand_is_around_the_brick_and_square_to_it(scene):
    grasp = Skill(scene(bricks(*ALONE)), add_grasp)
    at = grasp.thing.position + np.array([0.0, 0.0, 0.07 / 2 - 0.025])
    across_x, across_y = [0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0], [0.0, 1.0, 0.0, 0.0]
    assert grasp.done("reach", ee_pos=at, ee_quat=across_x)
    assert not grasp.done("reach", ee_pos=at, ee_quat=across_y)
    assert not grasp.done("reach", ee_pos=at + np.array([0.0, 0.0, 0.02]), ee_quat=across_x)


def test_after_a_repair_the_reach_may_be_done_from_farther_away(scene):
    one = scene(bricks(*ALONE))
    first, looser = Skill(one, add_grasp), Skill(one, add_grasp, adjustment=SkillAdjustment(loose=1.5))
    at = first.thing.position + np.array([0.0, 0.0, 0.07 / 2 - 0.025 + 0.015])
    across_x = [0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0]
    assert not first.done("reach", ee_pos=at, ee_quat=across_x)
    assert looser.done("reach", ee_pos=at, ee_quat=across_x)


def test_from_aside_the_way_leads_over_the_brick_first(scene):
    grasp = Skill(scene(bricks(*ALONE)), add_grasp)
    at = grasp.thing.position + np.array([0.0, 0.0, 0.01])
    beside, over = at + np.array([0.1, 0.0, 0.0]), at + np.array([0.1, 0.0, 0.055])
    assert grasp.terms("reach", ee_pos=over)["reach"] < grasp.terms("reach", ee_pos=beside)["reach"]


def test_a_lower_grasp_is_lower_but_not_in_the_table(scene):
    one = scene(bricks(*ALONE))
    first, lower, far = (Skill(one, add_grasp, adjustment=SkillAdjustment(lower_m=by)) for by in (0.0, 0.006, 1.0))
    quat = [0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0]
    depth = {skill: skill.thing.position + np.array([0.0, 0.0, up]) for skill, up in ((first, 0.01), (lower, 0.004))}
    assert all(skill.done("reach", ee_pos=at, ee_quat=quat) for skill, at in depth.items())
    assert far.done("reach", ee_pos=[*far.thing.position[:2], 0.012], ee_quat=quat)


def test_a_brick_that_rises_with_the_hand_costs_less_and_one_that_stays_behind_does_not(scene):
    lift = Skill(scene(bricks(*ALONE)), add_lift, 0.1)
    at = lift.thing.position
    hold = at + np.array([0.0, 0.0, 0.01])
    raised = lift.terms("lift", ee_pos=hold + np.array([0, 0, 0.125]), brick_pos=at + np.array([0, 0, 0.125]))
    alone = lift.terms("lift", ee_pos=hold + np.array([0, 0, 0.125]), brick_pos=at)
    assert raised["lift"] == pytest.approx(0.0, abs=1e-3)
    assert alone["lift"] == pytest.approx(1.25, abs=0.01)
    assert alone["hold"] > raised["hold"] + 0.5


def test_what_stands_in_between_is_cleared(scene):
    placement = Placement(where="self.there_pos", height_m=0.035, near_m=0.02, words="there")
    low, high = (
        Skill(
            scene(
                bricks(*ALONE, fixtures=[{"name": "post", "size": [0.02, 0.02, top], "position": [0.2, 0, top / 2]}])
            ),
            add_place,
            placement,
        )
        for top in (0.1, 0.2)
    )
    at = low.thing.position
    over = np.array([*at[:2], 0.2])
    assert low.done("raise", brick_pos=over)
    assert not high.done("raise", brick_pos=over)
    assert high.done("raise", brick_pos=at + np.array([0.0, 0.0, 0.25]))


def test_a_named_point_of_the_brick_is_carried_to_the_place(scene):
    shift = np.array([0.02, 0.0, 0.0])
    placement = Placement(where="self.there_pos", height_m=0.035, near_m=0.02, words="there", shift=shift)
    place = Skill(scene(bricks(*ALONE)), add_place, placement)
    there = np.array([0.1, 0.15, 0.035])
    assert place.done("carry", brick_pos=there - shift)
    assert not place.done("carry", brick_pos=there + shift)


def test_the_hand_retires_once_the_fingers_are_open(scene):
    release = Skill(scene(bricks(*ALONE)), add_release)
    assert release.done("release", gripper_opening=0.075)
    assert not release.done("release", gripper_opening=0.06)
    at = release.thing.position
    up = [release.terms("retire", ee_pos=at + np.array([0.0, 0.0, high]))["up"] for high in (0.02, 0.08, 0.135)]
    assert up == sorted(up, reverse=True)
