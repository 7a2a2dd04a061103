"""Building blocks of costs, on batches."""

import numpy as np
import pytest

from coral.contact.experts.terms import (
    ABREAST_M,
    axis,
    dot,
    facing,
    level,
    near,
    norm,
    on_box,
    palm_down,
    reach_terms,
    turned,
)
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


def test_points_of_a_box_turn_with_it(state_of):
    state = state_of(
        "flip-wall", box_pos=[0.1, 0.2, 0.03], box_quat=from_rpy_deg([0, 0, 90]), box_size=[0.1, 0.08, 0.06]
    )
    assert on_box(state, "box", 1.0, 0.0)[0, 0] == pytest.approx([0.1, 0.25, 0.03])
    assert on_box(state, "box", -1.0, 1.0)[0, 0] == pytest.approx([0.1, 0.15, 0.06])


@pytest.mark.parametrize("yaw", [0.0, 35.0, -90.0, 170.0])
def test_the_palm_is_down_and_the_fingers_stand_across_the_way_ahead(yaw, state_of):
    ahead = np.array([np.cos(np.radians(yaw)), np.sin(np.radians(yaw)), 0.0])
    hand = palm_down(ahead)
    assert axis(hand, "z") == pytest.approx([0.0, 0.0, -1.0])
    assert axis(hand, "x") == pytest.approx(ahead)
    assert facing(state_of("flip-wall", box_quat=from_rpy_deg([0, 0, yaw])), "box") == pytest.approx(hand)


def test_coming_down_costs_nothing_at_the_target_and_more_from_the_side_than_from_above(state_of):
    target = np.array([[[-0.1, 0.0, 0.02]]])

    def cost(place):
        state = state_of("flip-wall", ee_pos=place, gripper_target=ABREAST_M)
        terms = reach_terms(state, "box", target, np.zeros((1, 1)), above_m=0.09)
        return float(sum(np.asarray(term).item() for term in terms.values()))

    assert cost(target) == pytest.approx(0.0)
    above, aside = np.array([0.0, 0.0, 0.06]), np.array([0.0, 0.06, 0.0])
    assert cost(target + above) == pytest.approx(12.0 * 0.06)
    assert cost(target + aside) == pytest.approx(12.0 * 0.06 + 30.0 * 0.9 * 0.07)
