import numpy as np
import pytest
from skills import Skill, bricks

from coral.contact.rules.scene_reading import Thing
from coral.contact.rules.skill_edge import add_overhang, can_overhang

BOARD = (0.2, 0.3, 0.02)
"""A board whose long side lies along y."""


def table(reach_y=0.4):
    return {"size": [0.8, 2 * reach_y, 0.05], "center": [0.0, 0.0]}


def overhang(scene, at=(0.0, 0.1), **more):
    return Skill(scene(bricks(("brick", BOARD, at), **more)), add_overhang, 0.1)


@pytest.mark.parametrize(
    ("size", "can"), [(BOARD, True), ((0.2, 0.3, 0.1), False), ((0.06, 0.06, 0.06), False), ((0.2, 0.2, 0.07), True)]
)
def test_what_is_flat_and_long_can_be_pinched_beyond_the_edge(scene, size, can):
    assert can_overhang(Thing("brick", scene(bricks(("brick", size, (0.0, 0.0)))).facts)) == can


@pytest.mark.parametrize(("at", "normal"), [((0.0, 0.2), (0, -1, 0)), ((0.0, -0.2), (0, 1, 0))])
def test_the_end_nearest_to_an_edge_is_pushed_over_it_from_behind(scene, at, normal):
    push = next(region for region in overhang(scene, at).regions if region.approach == "push")
    assert push.normal == normal


def test_an_end_that_the_instruction_names_is_pushed_over_instead(scene):
    task = bricks(("brick", BOARD, (0.0, 0.2)), instruction="Take it by its handle.")
    handled = task.objects[0].model_copy(update={"points": {"handle": (0.0, -0.14, 0.0)}})
    one = scene(task.model_copy(update={"objects": (handled,)}))
    push = next(region for region in Skill(one, add_overhang, 0.1).regions if region.approach == "push")
    assert push.normal == (0, 1, 0)


def test_the_push_is_done_when_the_end_is_far_enough_over_the_edge(scene):
    skill = overhang(scene)
    edge = skill.one.facts["table"]["y"][1]
    # the grip is 2 cm from the end, and 5 cm of it are to be beyond the edge
    over = edge + 0.05 - (0.15 - 0.02)
    assert not skill.done("push", brick_pos=[0.0, over - 0.01, 0.01])
    assert skill.done("push", brick_pos=[0.0, over + 0.001, 0.01])
    short, enough, far = (skill.terms("push", brick_pos=[0.0, over + by, 0.01]) for by in (-0.05, 0.005, 0.06))
    assert short["overhang"] > enough["overhang"] == pytest.approx(0.0)
    assert far["not too far"] > enough["not too far"] == pytest.approx(0.0)


def test_the_number_of_the_task_says_how_far(scene):
    near, far = (overhang(scene, numbers={"overhang": by}) for by in (0.03, 0.06))
    edge = near.one.facts["table"]["y"][1]
    at = [0.0, edge + 0.04 - 0.13, 0.01]
    assert near.done("push", brick_pos=at)
    assert not far.done("push", brick_pos=at)


def test_the_pinch_is_across_its_thickness_beyond_the_edge(scene):
    skill = overhang(scene)
    pinch = next(region for region in skill.regions if region.approach == "pinch")
    assert (pinch.closing, pinch.stage) == (2, "insert")
    assert abs(pinch.normal[2]) < 1e-6
    assert pinch.center[1] > 0.1


def test_lifting_counts_the_end_that_stays_behind(scene):
    skill = overhang(scene)
    up = [0.0, 0.2, 0.16]
    level = skill.terms("lift", brick_pos=up)["lift"]
    half = np.radians(25) / 2
    hanging = skill.terms("lift", brick_pos=up, brick_quat=[np.cos(half), np.sin(half), 0.0, 0.0])["lift"]
    assert level == pytest.approx(0.0, abs=1e-9)
    assert hanging > 0.4
