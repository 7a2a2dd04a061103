import numpy as np
import pytest

from coral.contact.perception.motion_filter import MotionFilter, MotionFilterCfg
from coral.contact.scene.geometry import rotation_about, rotation_angle
from coral.contact.scene.rigid_transform import pose_matrix

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
