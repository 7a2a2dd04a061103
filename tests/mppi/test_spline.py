"""Splines over knots, against values worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.mppi.spline import basis, interpolate, shift

KINDS = ("hold", "linear", "cubic")


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("hold", [0.0, 0.0, 1.0, 1.0, 4.0]),
        ("linear", [0.0, 0.5, 1.0, 2.5, 4.0]),
        # Catmull-Rom with held ends: at s = 1/2 the weights are (-1, 9, 9, -1) / 16.
        ("cubic", [0.0, (9 * 1 - 4) / 16, 1.0, (9 * 1 + 9 * 4 - 4) / 16, 4.0]),
    ],
)
def test_between_three_knots(kind, expected):
    values = interpolate(np.array([[0.0], [1.0], [4.0]]), np.linspace(0, 2, 5), 2.0, kind)
    assert values[:, 0] == pytest.approx(expected)


@pytest.mark.parametrize("kind", KINDS)
def test_held_outside(kind):
    knots = np.array([[2.0, -1.0], [5.0, 3.0]])
    assert interpolate(knots, np.array([-3.0, 9.0]), 1.0, kind) == pytest.approx(knots)


@given(kind=st.sampled_from(KINDS), knots=st.integers(1, 8), steps=st.integers(1, 30), span=st.floats(0.1, 5))
def test_constants_stay_constant(kind, knots, steps, span):
    matrix = basis(np.linspace(0, span, steps), knots, span, kind)
    assert matrix.shape == (steps, knots)
    assert matrix.sum(axis=1) == pytest.approx(1.0)


@given(kind=st.sampled_from(KINDS), knots=st.integers(2, 12), span=st.floats(0.1, 5))
def test_passes_through_its_knots(kind, knots, span):
    assert basis(np.linspace(0, span, knots), knots, span, kind) == pytest.approx(np.eye(knots), abs=1e-6)


def test_batches_as_one_by_one():
    knots = np.random.default_rng(0).normal(size=(4, 5, 3))
    times = np.linspace(0, 1, 9)
    assert interpolate(knots, times, 1.0)[2] == pytest.approx(interpolate(knots[2], times, 1.0))


@pytest.mark.parametrize("kind", KINDS)
def test_shift_by_nothing_and_by_a_knot(kind):
    knots = np.array([[0.0], [1.0], [4.0], [9.0]])
    assert shift(knots, 0.0, 3.0, kind) == pytest.approx(knots)
    assert shift(knots, 1.0, 3.0, kind)[:, 0] == pytest.approx([1.0, 4.0, 9.0, 9.0])


def test_shift_by_half_a_knot():
    assert shift(np.array([[0.0], [1.0], [4.0]]), 0.5, 2.0)[:, 0] == pytest.approx([0.5, 2.5, 4.0])


def test_one_knot_is_a_constant():
    assert interpolate(np.array([[7.0]]), np.linspace(0, 1, 4), 1.0) == pytest.approx(np.full((4, 1), 7.0))


def test_the_kept_matrix_cannot_be_spoilt():
    with pytest.raises(ValueError, match="read-only"):
        basis(np.array([0.0, 1.0]), 2, 1.0)[0, 0] = 3.0
