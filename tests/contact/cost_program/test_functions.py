"""The functions that a cost may call give what NumPy and Python give, state by state."""

import math

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.functions import (
    add_up,
    clip,
    cross,
    isclose,
    largest,
    length,
    near,
    reduction,
    round_to,
    select,
    sigmoid,
)
from coral.contact.cost_program.values import ContactList, Partial, Seq, Vec

SAME = {
    "keepdims": (
        "m = np.stack([self.ee_pos, self.box_pos])\nu = m / np.linalg.norm(m, axis=1, keepdims=True)\n"
        "c = m - m.mean(axis=0, keepdims=True)\nreturn u[0, 0] + c[1, 2] + m.sum(keepdims=True)[0, 0]"
    ),
    "keepdims of a vector": "v = self.ee_pos\nreturn (v / v.max(keepdims=True))[0] + np.std(v, keepdims=True)[0]",
    "norms of a matrix": (
        "m = np.stack([self.ee_pos, self.box_pos])\n"
        "return np.linalg.norm(m) + np.linalg.norm(m, axis=0)[1] + np.linalg.norm(m, axis=1)[0]"
    ),
    "norms of a vector": (
        "v = self.ee_pos\nreturn np.linalg.norm(v, 1) + np.linalg.norm(v, ord=np.inf) + np.linalg.norm(v, 2)"
    ),
    "reductions along an axis": (
        "m = np.stack([self.ee_pos, self.box_pos])\n"
        "return m.max(axis=0)[2] + m.min(axis=1)[1] + np.prod(m, axis=-1)[0] + np.mean(m) + np.any(m > 0.3) * 5.0"
    ),
    "where over vectors": "v = self.ee_pos\nreturn np.sum(np.where(v > 0.1, v, self.box_pos) * [1.0, 2.0, 3.0])",
    "outer and cross": "return np.outer(self.ee_pos, self.box_pos)[2, 1] + np.cross(self.ee_pos, self.box_pos)[1]",
    "logic by functions": (
        "a = np.logical_and(self.time > 0.3, self.box_hand_contact)\n"
        "return 1.0 * np.logical_or(a, self.time > 0.9) + 2.0 * np.logical_not(a)"
    ),
}
REFUSED = {
    "axis of a number": ("return np.sum(self.time, axis=0)", "wrong_size", "no axis 0"),
    "moving order of a norm": ("return np.linalg.norm(self.ee_pos, self.time)", "wrong_call", "ord 1, 2"),
    "axis that is not there": ("return np.sum(self.ee_pos, axis=1)", "wrong_size", "a vector of 3 has no axis 1"),
    "largest of nothing": ("return np.max(np.zeros(0))", "wrong_size", "max of nothing"),
    "moving number of decimals": ("return np.round(self.time, self.current_step)", "wrong_call", "0 to 12 decimals"),
    "length of a number": ("return len(self.time)", "wrong_type", "a number has no length"),
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


def test_a_clip_has_two_bounds_or_one(meter):
    assert clip(meter, Vec((-2.0, 0.5, 3.0)), 0.0, 1.0).items == (0.0, 0.5, 1.0)
    assert clip(meter, Vec((-2.0, 3.0)), None, 1.0).items == (-2.0, 1.0)


def test_of_equal_numbers_the_first_is_the_largest_as_in_python(meter):
    assert largest(meter, (1, 1.0), ">") is max(1, 1.0)
    nans = np.array([[np.nan, 1.0]])
    assert np.array_equal(largest(meter, (nans, 0.5), ">"), [[np.nan, 1.0]], equal_nan=True)
    assert np.array_equal(largest(meter, (0.5, nans), ">"), [[0.5, 1.0]])


def test_a_choice_by_a_vector_of_conditions_is_made_entry_by_entry(meter):
    assert select(meter, Vec((True, False)), Vec((1.0, 2.0)), 9.0).items == (1.0, 9.0)
    with pytest.raises(CostError, match="a vector of 3 and a vector of 2"):
        select(meter, Vec((True, False)), Vec((1.0, 2.0, 3.0)), 9.0)


def test_an_entry_that_is_set_in_some_states_counts_as_zero_in_the_others(meter):
    found = add_up(meter, Seq((1.0, Partial(np.array([[4.0, 4.0]]), np.array([[True, False]])))))
    assert found.tolist() == [[5.0, 1.0]]


def test_contact_points_have_a_length_of_one_where_there_are_any(meter):
    assert length(meter, ContactList(np.array([[True, False]]))).tolist() == [[1.0, 0.0]]
    assert length(meter, Seq((1.0, 2.0))) == 2
    with pytest.raises(CostError, match="an iterator has no length"):
        length(meter, Seq((1.0,), "iterator"))


def test_a_cross_product_needs_two_vectors_of_three(meter):
    assert cross(meter, Vec((1.0, 0.0, 0.0)), Vec((0.0, 1.0, 0.0))).items == (0.0, 0.0, 1.0)
    with pytest.raises(CostError, match="not of 2 and 3"):
        cross(meter, Vec((1.0, 0.0)), Vec((0.0, 1.0, 0.0)))


def test_closeness_is_relative_to_the_second_number(meter):
    assert isclose(meter, 100.0, 100.0009)
    assert not isclose(meter, 100.0, 100.01)
    assert isclose(meter, 1.0, 1.05, atol=0.1, rtol=0.0)


def test_numbers_are_rounded_half_to_even(meter):
    assert round_to(meter, Vec((0.5, 1.5, 2.25)), 0).items == (0.0, 2.0, 2.0)
    assert round_to(meter, 2.25, 1) == 2.2


def test_nothing_sums_to_zero_and_multiplies_to_one(meter):
    assert reduction("sum")(meter, Vec(())) == 0
    assert reduction("prod")(meter, Vec(())) == 1.0
    assert reduction("all")(meter, Vec(())) is True
    assert reduction("any")(meter, Vec(())) is False
