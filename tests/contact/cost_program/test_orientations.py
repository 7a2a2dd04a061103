"""Orientation functions agree with SciPy, on (w, x, y, z) quaternions."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coral.contact.cost_program import CostError
from coral.contact.cost_program import orientations as o
from coral.contact.cost_program.values import Vec

A, B = (Rotation.from_euler("xyz", angles) for angles in ([0.3, -0.8, 1.9], [-2.0, 0.4, 0.1]))


def wxyz(rotation):
    return Vec(tuple(rotation.as_quat(scalar_first=True).tolist()))


def test_functions_of_one_orientation_agree_with_scipy(meter):
    v = [0.2, -0.5, 1.1]
    np.testing.assert_allclose(o.quat_rotate(meter, wxyz(A), Vec(tuple(v))).items, A.apply(v))
    for axis in range(3):
        np.testing.assert_allclose(o.quat_axis(meter, wxyz(A), axis).items, A.as_matrix()[:, axis])


def test_functions_of_two_orientations_agree_with_scipy(meter):
    assert o.quat_angle(meter, wxyz(A), wxyz(B)) == pytest.approx((B * A.inv()).magnitude())


def test_both_signs_of_a_quaternion_are_one_orientation(meter):
    opposite = Vec(tuple(-x for x in wxyz(A).items))
    assert o.quat_angle(meter, wxyz(A), opposite) == pytest.approx(0.0, abs=1e-12)
    assert o.quat_angle(meter, Vec((1.0, 0.0, 0.0, 0.0)), Vec((0.0, 1.0, 0.0, 0.0))) == pytest.approx(math.pi)


def test_an_axis_and_a_vector_that_are_none_are_refused(meter):
    with pytest.raises(CostError, match="0, 1 or 2"):
        o.quat_axis(meter, wxyz(A), 3)
    with pytest.raises(CostError, match="a vector of 3 is rotated, not of 2"):
        o.quat_rotate(meter, wxyz(A), Vec((1.0, 2.0)))
