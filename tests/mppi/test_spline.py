"""Splines over knots, against values worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.mppi.spline import basis, interpolate, shift


def test_between_three_knots():
    values = interpolate(np.array([[0.0], [1.0], [4.0]]), np.linspace(0, 2, 5), 2.0)
    assert values[:, 0] == pytest.approx([0.0, 0.5, 1.0, 2.5, 4.0])


def test_held_outside():
    knots = np.array([[2.0, -1.0], [5.0, 3.0]])
    assert interpolate(knots, np.array([-3.0, 9.0]), 1.0) == pytest.approx(knots)


@given(knots=st.integers(1, 8), steps=st.integers(1, 30), span=st.floats(0.1, 5))
def test_constants_stay_constant(knots, steps, span):
    matrix = basis(np.linspace(0, span, steps), knots, span)
    assert matrix.shape == (steps, knots)
    assert matrix.sum(axis=1) == pytest.approx(1.0)


@given(knots=st.integers(2, 12), span=st.floats(0.1, 5))
def test_passes_through_its_knots(knots, span):
    assert basis(np.linspace(0, span, knots), knots, span) == pytest.approx(np.eye(knots), abs=1e-6)


def test_batches_as_one_by_one():
    knots = np.random.default_rng(0).normal(size=(4, 5, 3))
    times = np.linspace(0, 1, 9)
    assert interpolate(knots, times, 1.0)[2] == pytest.approx(interpolate(knots[2], times, 1.0))


def test_shift_by_nothing_and_by_a_knot():
    knots = np.array([[0.0], [1.0], [4.0], [9.0]])
    assert shift(knots, 0.0, 3.0) == pytest.approx(knots)
    assert shift(knots, 1.0, 3.0)[:, 0] == pytest.approx([1.0, 4.0, 9.0, 9.0])


def test_shift_by_half_a_knot():
    assert shift(np.array([[0.0], [1.0], [4.0]]), 0.5, 2.0)[:, 0] == pytest.approx([0.5, 2.5, 4.0])


def test_one_knot_is_a_constant():
    assert interpolate(np.array([[7.0]]), np.linspace(0, 1, 4), 1.0) == pytest.approx(np.full((4, 1), 7.0))


def test_the_kept_matrix_cannot_be_spoilt():
    with pytest.raises(ValueError, match="read-only"):
        basis(np.array([0.0, 1.0]), 2, 1.0)[0, 0] = 3.0
