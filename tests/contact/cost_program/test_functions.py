"""The functions that a cost may call give what NumPy and Python give, state by state."""

import math

import numpy as np
import pytest

from coral.contact.cost_program.functions import add_up, largest, near, sigmoid
from coral.contact.cost_program.values import Partial, Seq

SAME = {
    "where over vectors": "v = self.ee_pos\nreturn np.sum(np.where(v > 0.1, v, self.box_pos) * [1.0, 2.0, 3.0])",
    "cross": "return np.cross(self.ee_pos, self.box_pos)[1]",
    "reductions": (
        "v = self.ee_pos\nreturn np.sum(v) + 2.0 * np.mean(v) + 4.0 * np.max(v) + 8.0 * v.min() + np.sum(self.time)"
    ),
    "any and all of an array": "v = self.ee_pos\nreturn 1.0 * np.any(v > 0.2) + 2.0 * (v > -0.3).all()",
    "length of a number": "return np.linalg.norm(self.time - 0.5) + norm(self.ee_pos[:2])",
    "one bound of a clip": "return np.sum(np.clip(self.ee_pos, None, 0.1))",
    "rounding": "return 10.0 * round(self.time) + math.floor(self.ee_pos[0])",
}
REFUSED = {
    "an exception of math": ("return max(0.0, math.sqrt(self.time - 10.0))", "not_finite", "math raises"),
    "decimals of round": ("return round(self.time, 2)", "wrong_call", "not 2 arguments"),
    "length along an axis": ("return np.linalg.norm(self.ee_pos, axis=0)", "wrong_call", "not axis="),
    "truth values": ("return np.exp(self.box_hand_contact)", "wrong_type", "write float"),
    "int of infinity": ("return int(1.0 / (0.0 * self.time))", "too_large_number", "guard it"),
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


def test_an_exception_of_math_counts_only_where_its_line_does(agrees):
    agrees("return math.sqrt(self.ee_pos[0]) if self.ee_pos[0] > 0.0 else 0.5")


def test_the_sigmoid_does_not_overflow(meter):
    with np.errstate(all="raise"):
        assert [sigmoid(meter, x) for x in (-1e6, 0.0, 1e6)] == [0.0, 0.5, 1.0]
    assert sigmoid(meter, 2.0) == pytest.approx(1.0 / (1.0 + math.exp(-2.0)))


def test_near_is_a_bell_of_the_given_width(meter):
    assert near(meter, 0.0, 0.1) == 1.0
    assert near(meter, 0.1, 0.1) == pytest.approx(math.exp(-1.0))


def test_of_equal_numbers_the_first_is_the_largest_as_in_python(meter):
    assert largest(meter, (1, 1.0), ">") is max(1, 1.0)
    nans = np.array([[np.nan, 1.0]])
    assert np.array_equal(largest(meter, (nans, 0.5), ">"), [[np.nan, 1.0]], equal_nan=True)
    assert np.array_equal(largest(meter, (0.5, nans), ">"), [[0.5, 1.0]])


def test_an_entry_that_is_set_in_some_states_counts_as_zero_in_the_others(meter):
    found = add_up(meter, Seq((1.0, Partial(np.array([[4.0, 4.0]]), np.array([[True, False]])))))
    assert found.tolist() == [[5.0, 1.0]]
