"""Transforms at any time."""

import math

import numpy as np
import pytest

from coral.reef.recordings.pose_track import StampedTransforms
from coral.reef.recordings.transforms import body_transform, euler_of
from coral.reef.world.geometry import Pose


def track(*stamped):
    made = StampedTransforms()
    for t, x, yaw in stamped:
        made.add(t, body_transform(Pose(x, 0.0, yaw), 1.0, 0.0, 0.0))
    return made


def test_between_two_poses_the_way_is_straight_and_the_turn_even():
    made = track((1.0, 0.0, math.radians(170)), (1.2, 1.0, math.radians(-170))).at(1.15)
    assert made[0, 3] == pytest.approx(0.75)
    assert math.degrees(euler_of(made[:3, :3])[2]) == pytest.approx(-175)


def test_a_pose_of_the_same_stamp_is_taken_to_the_last_bit():
    stamped = track((1.0, 0.3, 0.2), (1.2, 1.0, 0.4))
    assert stamped.at(1.2) is stamped.transforms[1]


def test_far_from_all_poses_there_is_none():
    stamped = track((1.0, 0.0, 0.0), (3.0, 1.0, 0.0))
    assert stamped.at(2.0) is None
    assert stamped.at(3.05)[0, 3] == 1.0
    assert stamped.at(3.2) is None
    assert StampedTransforms().at(1.0) is None


def test_messages_a_little_out_of_order_are_sorted_and_a_clock_set_back_is_told():
    stamped = track((1.0, 0.0, 0.0), (1.1, 2.0, 0.0), (1.05, 1.0, 0.0))
    assert [one[0, 3] for one in stamped.transforms] == [0.0, 1.0, 2.0]
    with pytest.raises(ValueError, match=r"0\.500 s after one of 1\.100 s"):
        stamped.add(0.5, np.eye(4))
