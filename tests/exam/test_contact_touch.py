import dataclasses
import math

import numpy as np
import pytest

from coral.contact.plan.contact_regions import Region
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.exam.contact_touch import fits, touches

AT_REST = [0.0, 0.0, 0.03, 1.0, 0.0, 0.0, 0.0]
QUARTER = [0.0, 0.0, 0.03, math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
"""Turned by 90 degrees about z."""
SIZE = [0.06, 0.06, 0.12]
PUSH = {"object": "box", "how": ["push", "press"], "side": [-1.0, 0.0, 0.0]}
PINCH = {"object": "box", "how": ["pinch"], "side": None}


def wanted(task, seed=0):
    return touches(sample_trial(load_task(task), seed))


def region(normal, approach="push", center=(0.0, 0.0, 0.0)):
    return Region(center=center, normal=normal, approach=approach)


def test_what_is_pushed_is_touched_on_the_side_that_faces_away_from_the_place():
    trial = sample_trial(load_task("push-force"), 0)
    (touch,) = touches(trial)
    name = touch["object"]
    (goal,) = (one for one in trial.task.success.conditions if one.kind == "at")
    way = np.asarray(trial.task.places[goal.place])[:2] - trial.objects[name].pose.position[:2]
    np.testing.assert_allclose(touch["side"], [*(-way / np.linalg.norm(way)), 0.0], atol=1e-4)
    assert touch["how"] == ["push", "press"]


def test_the_side_turns_as_the_object_stands_elsewhere():
    trial = sample_trial(load_task("push-force"), 0)
    (name,) = trial.objects
    (place,) = trial.task.places.values()
    beyond = dataclasses.replace(
        trial.objects[name].pose, position=np.asarray(place, dtype=float) + np.array([0.1, 0.0, 0.0])
    )
    moved = dataclasses.replace(trial, objects={name: dataclasses.replace(trial.objects[name], pose=beyond)})
    assert touches(moved)[0]["side"] == [1.0, 0.0, 0.0]


def test_what_is_lifted_is_pinched_anywhere():
    (touch,) = wanted("pick-box")
    assert (touch["how"], touch["side"]) == (["pinch"], None)


def test_a_board_that_is_too_wide_is_pushed_over_the_edge_and_pinched():
    assert {tuple(touch["how"]) for touch in wanted("push-pick-board")} == {("pinch",), ("push", "press")}


def test_what_is_turned_over_is_touched_from_the_robots_side_and_high_where_no_wall_holds_it():
    (alone,), (wall,) = wanted("flip-box"), wanted("flip-wall")
    assert alone["side"] == wall["side"] == [-1.0, 0.0, 0.0]
    assert (alone["high"], wall["high"]) == (True, False)


@pytest.mark.parametrize(
    ("normal", "approach", "pose", "found"),
    [
        ((-1, 0, 0), "push", AT_REST, True),
        ((-1, 0, 0), "press", AT_REST, True),
        ((-1, 0, 0), None, AT_REST, True),
        ((-1, 0, 0), "pinch", AT_REST, False),
        ((1, 0, 0), "push", AT_REST, False),
        ((0, 1, 0), "push", AT_REST, False),
        ((0, 1, 0), "push", QUARTER, True),
        ((-1, 0, 0), "push", QUARTER, False),
        ((-math.cos(0.85), math.sin(0.85), 0), "push", AT_REST, True),  # 49 degrees
        ((-math.cos(0.9), math.sin(0.9), 0), "push", AT_REST, False),  # 52 degrees
    ],
)
def test_a_place_to_push_is_right_within_50_degrees_of_the_side(normal, approach, pose, found):
    assert fits(region(normal, approach), "box", PUSH, pose, SIZE) is found


def test_a_touch_of_another_object_is_none():
    assert not fits(region((-1, 0, 0)), "cup", PUSH, AT_REST, SIZE)


def test_what_has_to_be_touched_high_is_not_touched_below_its_middle():
    high = PUSH | {"high": True}
    assert fits(region((-1, 0, 0), center=(-0.03, 0, 0.02)), "box", high, AT_REST, SIZE)
    assert not fits(region((-1, 0, 0), center=(-0.03, 0, -0.02)), "box", high, AT_REST, SIZE)


def test_a_grasp_is_one_by_name_or_where_the_fingers_close():
    assert fits(region((0, 0, 1), "pinch"), "box", PINCH, AT_REST, SIZE)
    assert fits(region((0, 0, 1), None), "box", PINCH, AT_REST, SIZE)
    assert not fits(region((0, 0, 1), None), "box", PINCH, AT_REST, [0.2, 0.2, 0.1])
    assert not fits(region((0, 0, 1), "push"), "box", PINCH, AT_REST, SIZE)
