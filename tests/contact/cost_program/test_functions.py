"""The functions that a cost may call give what NumPy and Python give, state by state; orientations what SciPy gives."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coral.contact.cost_program import CostError
from coral.contact.cost_program.functions import (
    add_up,
    largest,
    near,
    quat_angle,
    quat_axis,
    quat_rotate,
    sigmoid,
)
from coral.contact.cost_program.values import Partial

A, B = (Rotation.from_euler("xyz", angles) for angles in ([0.3, -0.8, 1.9], [-2.0, 0.4, 0.1]))

SAME = {
    "where over vectors": "v = self.ee_pos\nreturn np.sum(np.where(v > 0.1, v, self.box_pos) * [1.0, 2.0, 3.0])",
    "cross": "return np.cross(self.ee_pos, self.box_pos)[1]",
    "reductions": (
        "v = self.ee_pos\nreturn np.sum(v) + 2.0 * np.mean(v) + 4.0 * np.max(v) + 8.0 * v.min() + np.sum(self.time)"
    ),
    "any and all of an array": "v = self.ee_pos\nreturn 1.0 * np.any(v > 0.2) + 2.0 * (v > -0.3).all()",
    "length of a number": "return np.linalg.norm(self.time - 0.5) + norm(self.ee_pos[:2])",
    "one bound of a clip": "return np.sum(np.clip(self.ee_pos, None, 0.1))",
    "array of floats by its type": "v = np.array([0, 1], dtype=float)\nreturn v[1] / 3 + self.time",
    "asarray of an array": "return np.asarray(self.ee_pos)[1] + np.array(self.ee_pos.copy())[2]",
    "concatenate": "m = np.concatenate([self.ee_vel, np.zeros(2), [1.0]])\nreturn np.sum(m) + m[5]",
    "append a number": "v = np.append(self.ee_pos[:2], 0.12)\nreturn np.sum(v) + v[2]",
    "append a vector": "v = np.append(self.ee_pos, self.ee_vel)\nreturn np.sum(v) + v[5]",
    "ones": "return np.dot(np.ones(3), self.ee_pos)",
    "whole numbers": "v = np.array([3, 2])\nreturn v[0] // v[1] + self.time",
}
REFUSED = {
    "length along an axis": ("return np.linalg.norm(self.ee_pos, axis=0)", "wrong_call", "unexpected keyword"),
    "truth values": ("return np.exp(self.box_hand_contact)", "wrong_type", "write float"),
    "other types": ("return np.array([0.0, 1.0], dtype=abs)[0]", "wrong_call", "float64 only"),
    "two axes": ("return np.zeros((2, 2))[0][0]", "not_fixed", "an array has one axis"),
    "rows": ("return np.array([self.ee_pos, self.box_pos])[0][0]", "wrong_size", "write a list of vectors"),
    "stack": ("return np.stack([self.ee_pos, self.box_pos])[0][0]", "unknown_attribute", "write a list of vectors"),
    "no entries": ("return np.sum(self.ee_pos[3:])", "wrong_size", "at least one entry"),
    "a number": ("return np.array(self.time)", "wrong_type", "takes a vector"),
    "a list of numbers": (
        "return np.concatenate([1.0, 2.0])[0]",
        "wrong_type",
        "needed here, not a number",
    ),
    "nothing to join": ("return np.concatenate([])[0]", "wrong_call", "a list of arrays"),
    "cross of two": ("return np.cross(self.ee_pos[:2], self.box_pos)[0]", "wrong_size", "not of 2 and 3"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_function_gives_what_numpy_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_arguments_that_do_not_fit_are_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found


def test_the_sigmoid_does_not_overflow(meter):
    with np.errstate(all="raise"):
        assert [sigmoid(meter, x) for x in (-1e6, 0.0, 1e6)] == [0.0, 0.5, 1.0]
    assert sigmoid(meter, 2.0) == pytest.approx(1.0 / (1.0 + math.exp(-2.0)))


def test_near_is_a_bell_of_the_given_width(meter):
    assert near(meter, 0.0, 0.1) == 1.0
    assert near(meter, 0.1, 0.1) == pytest.approx(math.exp(-1.0))


def test_of_equal_numbers_the_first_is_the_largest_as_in_python(meter):
    assert largest(meter, [1, 1.0], ">") is max(1, 1.0)
    nans = np.array([[np.nan, 1.0]])
    assert np.array_equal(largest(meter, (nans, 0.5), ">"), [[np.nan, 1.0]], equal_nan=True)
    assert np.array_equal(largest(meter, (0.5, nans), ">"), [[0.5, 1.0]])


def test_an_entry_that_is_set_in_some_states_counts_as_zero_in_the_others(meter):
    found = add_up(meter, [1.0, Partial(np.array([[4.0, 4.0]]), np.array([[True, False]]))])
    assert found.tolist() == [[5.0, 1.0]]


def wxyz(rotation):
    return rotation.as_quat(scalar_first=True).tolist()


def test_functions_of_one_orientation_agree_with_scipy(meter):
    v = [0.2, -0.5, 1.1]
    np.testing.assert_allclose(quat_rotate(meter, wxyz(A), v).ravel(), A.apply(v))
    for axis in range(3):
        np.testing.assert_allclose(quat_axis(meter, wxyz(A), axis).ravel(), A.as_matrix()[:, axis])


def test_functions_of_two_orientations_agree_with_scipy(meter):
    assert quat_angle(meter, wxyz(A), wxyz(B)) == pytest.approx((B * A.inv()).magnitude())


def test_both_signs_of_a_quaternion_are_one_orientation(meter):
    assert quat_angle(meter, wxyz(A), [-x for x in wxyz(A)]) == pytest.approx(0.0, abs=1e-12)
    assert quat_angle(meter, [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]) == pytest.approx(math.pi)


def test_an_axis_and_a_vector_that_are_none_are_refused(meter):
    with pytest.raises(CostError, match="0, 1 or 2"):
        quat_axis(meter, wxyz(A), 3)
    with pytest.raises(CostError, match="a vector of 3 is rotated, not of 2"):
        quat_rotate(meter, wxyz(A), [1.0, 2.0])
