"""Poses between and after measurements."""

import math

import pytest

from coral.reef.pilot.dead_reckoning import PoseHistory, between, moved_on
from coral.reef.vehicle.sensing import Stamped
from coral.reef.world.geometry import Pose


def history(*poses):
    made = PoseHistory(longest_s=0.5)
    for t, pose in poses:
        made.add(Stamped(t, pose))
    return made


def test_there_is_no_pose_before_the_first():
    assert history().at(1.0) is None


def test_at_its_own_time_a_pose_is_returned_as_it_is():
    pose = Pose(0.1, 0.2, 7.0)
    assert history((1.0, pose)).at(1.0) is pose


def test_a_late_picture_gets_the_pose_of_its_exposure():
    poses = history((1.0, Pose(0.0, 0.0, 3.0)), (2.0, Pose(1.0, 2.0, -3.0)), (3.0, Pose(9.0, 9.0, 0.0)))
    turn = 2 * math.pi - 6.0
    assert poses.at(1.25) == pytest.approx((0.25, 0.5, 3.0 + 0.25 * turn))
    assert poses.at(0.0) == (0.0, 0.0, 3.0)  # older than what is remembered: the oldest


def test_after_the_last_pose_the_velocity_moves_it_on_for_a_while():
    poses = history((1.0, Pose(0.0, 0.0, math.pi / 2)))
    poses.velocity = (0.6, 0.0, 0.0)
    assert poses.at(1.4) == pytest.approx((0.0, 0.24, math.pi / 2))
    assert poses.at(9.0) == pytest.approx((0.0, 0.3, math.pi / 2))


def test_half_a_turn_on_the_spot_and_a_drift_to_the_side():
    assert moved_on(Pose(1.0, 1.0, 0.0), (0.0, 0.0, 0.5), 1.0) == pytest.approx((1.0, 1.0, 0.5))
    assert moved_on(Pose(0.0, 0.0, 0.0), (0.0, 0.2, 0.0), 0.5) == pytest.approx((0.0, 0.1, 0.0))


def test_a_clock_that_was_set_takes_the_poses_with_it():
    poses = history((1.0, Pose(0.0, 0.0, 0.0)), (2.0, Pose(1.0, 0.0, 0.0)))
    poses.shift(-30.0)
    assert poses.at(-28.5) == pytest.approx((0.5, 0.0, 0.0))
    assert between(Pose(0, 0, 0), Pose(1, 0, 0), 0.5) == (0.5, 0.0, 0.0)
