"""An object in the hand moves with it; in the world it stays where it was."""

import numpy as np
import pytest
from solid_object import solid

from coral.contact.perception.tracked_object import MotionFilter, MotionFilterCfg, TrackedObject, is_grasped
from coral.contact.scene.geometry import pose_matrix, rotation_about, rotation_angle

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


CFG = MotionFilterCfg()
Z = np.array([0.0, 0.0, 1.0])


def at(x, turn=0.0):
    return pose_matrix(rotation_about(Z, turn), np.array([x, 0.0, 0.0]))


def test_noise_about_one_place_is_rest_and_is_averaged():
    rng = np.random.default_rng(0)
    still = MotionFilter(CFG, at(0.0), 0.0)
    for k in range(1, 20):
        still.update(at(rng.normal(scale=0.0005)), 0.04 * k)
    assert still.resting
    assert abs(still.predict(1.0)[0, 3]) < 0.0005


def test_an_even_motion_is_carried_on_to_now():
    moving = MotionFilter(CFG, at(0.0), 0.0)
    for k in range(1, 30):
        moving.update(at(0.1 * 0.04 * k, 0.5 * 0.04 * k), 0.04 * k)
    assert moving.velocity[0] == pytest.approx(0.1, abs=0.005)
    ahead = moving.predict(29 * 0.04 + 0.04)
    assert ahead[0, 3] == pytest.approx(0.12, abs=0.001)
    assert rotation_angle(ahead[:3, :3], rotation_about(Z, 0.6)) < 0.01


def test_a_motion_is_not_carried_on_for_ever():
    moving = MotionFilter(CFG, at(0.0), 0.0)
    for k in range(1, 10):
        moving.update(at(0.02 * k), 0.04 * k)
    assert moving.predict(100.0)[0, 3] == moving.predict(0.36 + CFG.longest_s)[0, 3]


def test_a_picture_from_before_the_motion_began_gives_no_speed():
    late = MotionFilter(CFG, at(0.0), 1.0)
    late.update(at(0.02), 0.96)
    assert not late.velocity.any()
    assert 0.0 < late.predict(1.0)[0, 3] <= 0.02


def box():
    return solid(("box", (0.03, 0.02, 0.03)))


def held(x=0.0, y=0.0, opening=0.04, wanted=-0.03, before=False):
    T = np.eye(4)
    T[:3, 3] = x, y, 0.0
    return is_grasped(box(), T, opening, wanted, before)


def test_fingers_that_press_on_an_object_hold_it():
    assert held()


def test_open_fingers_hold_nothing():
    assert not held(wanted=0.04)


def test_fingers_that_press_on_something_else_do_not_hold_it():
    assert not held(x=0.2)
    assert not held(opening=0.01)


def test_a_grip_is_kept_more_easily_than_made():
    assert not held(y=0.012)
    assert held(y=0.012, before=True)
