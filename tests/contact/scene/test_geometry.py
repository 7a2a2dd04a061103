"""Rotations, against values known by heart and against each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from coral.contact.scene.geometry import (
    angle_between,
    body_to_matrix,
    from_rotvec,
    from_rpy_deg,
    inverse_transform,
    matrix_to_body,
    multiply,
    pose_matrix,
    quaternion_of,
    rotate,
    rotation_about,
    rotation_angle,
    rotation_from_vector,
    rotation_of,
    rotation_vector,
    spread_rotations,
    to_rotvec,
)
from coral.contact.scene.observation import BodyState

ROOT = np.sqrt(0.5)
VECTORS = arrays(float, 3, elements=st.floats(-10, 10))
TURNS = VECTORS.map(lambda v: from_rotvec(v))
QUARTER = rotation_about([0.0, 0.0, 1.0], np.pi / 2)


@pytest.mark.parametrize(
    ("rpy", "quaternion", "x_goes_to"),
    [
        ((0, 0, 0), (1, 0, 0, 0), (1, 0, 0)),
        ((0, 0, 90), (ROOT, 0, 0, ROOT), (0, 1, 0)),
        ((0, 90, 0), (ROOT, 0, ROOT, 0), (0, 0, -1)),
        ((90, 0, 0), (ROOT, ROOT, 0, 0), (1, 0, 0)),
        ((180, 0, 0), (0, 1, 0, 0), (1, 0, 0)),
        ((90, 0, 90), (0.5, 0.5, 0.5, 0.5), (0, 1, 0)),
    ],
)
def test_known_turns(rpy, quaternion, x_goes_to):
    found = from_rpy_deg(rpy)
    assert found == pytest.approx(quaternion, abs=1e-12)
    assert rotate(found, [1, 0, 0]) == pytest.approx(x_goes_to, abs=1e-12)
    assert rotation_of(found)[:, 0] == pytest.approx(x_goes_to, abs=1e-12)


@given(TURNS, VECTORS)
def test_matrix_and_quaternion_turn_alike(q, v):
    assert rotate(q, v) == pytest.approx(rotation_of(q) @ v, abs=1e-9)


@given(TURNS)
def test_rotation_vector_round_trip(q):
    vector = to_rotvec(q)
    assert np.linalg.norm(vector) <= np.pi + 1e-9
    assert abs(from_rotvec(vector) @ q) == pytest.approx(1.0)


@pytest.mark.parametrize("degrees", [0.0, 1e-7, 1.0, 90.0, 179.0, 180.0])
def test_angles(degrees):
    turn = from_rotvec(np.radians(degrees) * np.array([0.6, 0, 0.8]))
    assert np.degrees(angle_between([1, 0, 0, 0], turn)) == pytest.approx(degrees, abs=1e-6)


def test_more_than_half_a_turn_comes_back_the_short_way():
    assert to_rotvec(from_rotvec([0, 0, np.radians(200)])) == pytest.approx([0, 0, np.radians(-160)])


def test_batches_as_one_by_one():
    rng = np.random.default_rng(0)
    q = from_rotvec(rng.normal(size=(4, 2, 3)))
    v = rng.normal(size=(4, 2, 3))
    assert rotate(q, v)[3, 1] == pytest.approx(rotate(q[3, 1], v[3, 1]))
    assert rotation_of(q)[3, 1] == pytest.approx(rotation_of(q[3, 1]))
    assert multiply(q, q[0, 0])[2, 1] == pytest.approx(multiply(q[2, 1], q[0, 0]))
    assert to_rotvec(q)[1, 0] == pytest.approx(to_rotvec(q[1, 0]))


def test_a_matrix_that_is_nearly_a_rotation_gives_the_nearest():
    turn = from_rpy_deg((20, -30, 40))
    assert abs(quaternion_of(rotation_of(turn) + 1e-4) @ turn) == pytest.approx(1, abs=1e-6)


def test_matrices_of_an_axis_and_an_angle():
    np.testing.assert_allclose(rotation_about([0, 0, 1.0], np.pi / 2) @ [1.0, 0, 0], [0, 1.0, 0], atol=1e-12)
    turn = np.array([0.3, -1.1, 0.7])
    np.testing.assert_allclose(rotation_vector(rotation_from_vector(turn)), turn, atol=1e-12)
    assert rotation_angle(rotation_about([1.0, 0, 0], 0.2), rotation_about([1.0, 0, 0], 0.9)) == pytest.approx(0.7)


def test_spread_rotations_leave_no_gap_and_do_not_repeat():
    turns = spread_rotations(300)
    np.testing.assert_allclose(turns @ turns.transpose(0, 2, 1), np.broadcast_to(np.eye(3), turns.shape), atol=1e-12)
    others = np.array([rotation_from_vector(v) for v in np.random.default_rng(0).normal(size=(30, 3))])

    def angles(those):
        """Between each of those and each of the rotations (degrees)."""
        traces = np.einsum("aij,bij->ab", those, turns)
        return np.degrees(np.arccos(np.clip(0.5 * (traces - 1.0), -1.0, 1.0)))

    assert angles(others).min(axis=1).max() < 40
    assert angles(turns[:1])[0, 1:].min() > 10


def test_a_pose_rotates_and_then_shifts():
    T = pose_matrix(QUARTER, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(T @ [1.0, 0.0, 0.0, 1.0], [1.0, 3.0, 3.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(inverse_transform(T) @ [1.0, 3.0, 3.0, 1.0], [1.0, 0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(inverse_transform(T), np.linalg.inv(T), atol=1e-12)


def test_a_body_comes_back_from_its_matrix():
    body = BodyState(np.array([0.1, -0.2, 0.3]), from_rotvec([0.3, -0.4, 0.5]), np.ones(3), np.ones(3))
    T = body_to_matrix(body)
    back = matrix_to_body(T)
    np.testing.assert_allclose(back.position, body.position)
    np.testing.assert_allclose(back.quaternion, body.quaternion, atol=1e-12)
    assert not back.velocity.any()  # a pose says nothing of motion
