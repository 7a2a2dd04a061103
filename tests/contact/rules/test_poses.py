import numpy as np
import pytest

from coral.advisor.question import Rejection
from coral.contact.rules.poses import estimate_poses
from coral.contact.thinker.pose_question import LEAST_PIXELS

ON_ITS_SIDE = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
"""Turned by 90 degrees about x: the object's y axis points up."""


def facts(pixels=500, seen=((0.1, 0.2, 0.0), (0.14, 0.28, 0.1)), quat=ON_ITS_SIDE, middle=(0.0, 0.0, 0.0)):
    item = {
        "label": "box",
        "size_m": [0.04, 0.1, 0.08],
        "middle_m": list(middle),
        "points_m": {},
        "usual_pose": [-0.2, -0.1, 0.3, *quat],
        "pixels": pixels,
        "seen_box_m": [list(corner) for corner in seen] if seen else None,
    }
    return {"objects": {"box": item}}


def guess(*rejections, **given):
    return estimate_poses(facts(**given), rejections).root["box"]


def test_an_object_is_in_the_middle_of_its_measured_depth_and_half_its_height_below_the_top_of_it():
    found = guess()
    assert found.position == pytest.approx((0.12, 0.24, 0.05))
    assert found.quaternion == ON_ITS_SIDE


def test_the_height_is_that_of_the_usual_orientation():
    assert guess(quat=(1.0, 0.0, 0.0, 0.0)).position[2] == pytest.approx(0.1 - 0.04)


def test_no_centre_lies_below_the_table():
    assert guess(seen=((0.1, 0.2, 0.0), (0.14, 0.28, 0.02))).position[2] == 0.0


def test_what_is_not_seen_is_held_to_be_where_it_usually_is():
    assert guess(pixels=0, seen=None).position == pytest.approx((-0.2, -0.1, 0.05))
    beside = guess(pixels=0, seen=None, middle=(0.01, 0.0, 0.02)).position
    assert beside == pytest.approx((-0.19, -0.12, 0.05))


def test_what_is_hardly_seen_or_was_refused_is_held_to_be_there_too():
    assert guess(pixels=LEAST_PIXELS).position == guess().position
    assert guess(pixels=LEAST_PIXELS - 1).position == guess(seen=None).position
    assert guess(Rejection(code="place", reason="off the table")).position == guess(seen=None).position
