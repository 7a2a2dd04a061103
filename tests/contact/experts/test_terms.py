"""Building blocks of costs, on batches."""

import numpy as np
import pytest

from coral.contact.experts.terms import axis, dot, level, near, norm, turned
from coral.contact.scene.geometry import from_rotvec, from_rpy_deg, rotation_of

BATCH = np.random.default_rng(0).normal(size=(2, 4, 5, 3))


def test_products_and_lengths_are_taken_along_the_last_axis():
    assert dot(BATCH[0], BATCH[1]) == pytest.approx(np.einsum("khi,khi->kh", BATCH[0], BATCH[1]))
    assert norm(BATCH[0]) == pytest.approx(np.linalg.norm(BATCH[0], axis=-1))
    assert norm(BATCH[0][..., :1]) == pytest.approx(np.abs(BATCH[0][..., 0]))


def test_the_axes_of_an_orientation_are_the_columns_of_its_matrix():
    quaternion = from_rpy_deg([20, -30, 70])
    found = np.stack([axis(quaternion, name) for name in "xyz"], axis=-1)
    assert found == pytest.approx(rotation_of(quaternion))


def test_a_bonus_is_whole_at_its_target_and_almost_gone_at_twice_its_scale():
    assert near(np.array([0.0, 0.1, -0.1, 0.2]), 0.1) == pytest.approx([1.0, np.exp(-1), np.exp(-1), np.exp(-4)])


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.5, np.pi])
def test_the_angle_between_orientations_does_not_depend_on_their_signs(angle):
    first = from_rpy_deg([10, 20, 30])
    turn = from_rotvec(angle * np.array([0.0, 0.6, 0.8]))
    identity = np.array([1.0, 0.0, 0.0, 0.0])
    assert turned(identity, turn) == pytest.approx(angle, abs=1e-6)
    assert turned(identity, -turn) == pytest.approx(angle, abs=1e-6)
    assert turned(first, first) == pytest.approx(0.0, abs=1e-6)


def test_a_level_rises_straight_between_its_bounds():
    assert level(np.array([-1.0, 0.2, 0.3, 0.4, 9.0]), 0.2, 0.4) == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])
