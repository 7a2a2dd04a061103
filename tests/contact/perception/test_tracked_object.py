"""An object in the hand moves with it; in the world it stays where it was."""

import numpy as np
import pytest

from coral.contact.perception.motion_filter import MotionFilter, MotionFilterCfg
from coral.contact.perception.tracked_object import TrackedObject
from coral.contact.scene.geometry import rotation_about
from coral.contact.scene.rigid_transform import pose_matrix

PLACE = pose_matrix(rotation_about([0.0, 0.0, 1.0], 0.4), [0.3, 0.1, 0.05])
TOOL = pose_matrix(rotation_about([1.0, 0.0, 0.0], np.pi), [0.3, 0.1, 0.2])


@pytest.fixture
def one():
    one = TrackedObject(None)
    one.motion = MotionFilter(MotionFilterCfg(), PLACE, 0.0)
    return one


def test_it_stays_where_it_is_while_the_hand_passes(one):
    np.testing.assert_array_equal(one.at(TOOL, 0.0), PLACE)
    np.testing.assert_array_equal(one.at(pose_matrix(np.eye(3), np.ones(3)), 0.0), PLACE)


def test_held_it_moves_with_the_hand_and_stays_where_it_is_let_go(one):
    one.hold(True, TOOL, 0.0)
    np.testing.assert_allclose(one.at(TOOL, 0.0), PLACE, atol=1e-12)  # grasping moves nothing
    lift = pose_matrix(rotation_about([0.0, 0.0, 1.0], 0.5), [0.0, 0.1, 0.15])
    np.testing.assert_allclose(one.at(lift @ TOOL, 0.1), lift @ PLACE, atol=1e-12)
    one.hold(False, lift @ TOOL, 0.1)
    np.testing.assert_allclose(one.at(TOOL, 0.2), lift @ PLACE, atol=1e-12)


def test_in_the_hand_pictures_count_less_and_give_no_velocity(one):
    one.hold(True, TOOL, 0.0)
    before = one.known.predict(0.0)
    shifted = before.copy()
    shifted[0, 3] += 0.01
    one.known.update(shifted, 0.04)
    assert one.known.predict(0.04)[0, 3] - before[0, 3] == pytest.approx(0.3 * 0.01)
    assert not one.known.velocity.any()
