"""After a branch each state keeps the values of the side that it took."""

import numpy as np
import pytest

from coral.contact.cost_program.merging import filled, merge, merge_variables
from coral.contact.cost_program.values import Partial, Poison

FIRST = np.array([[True, False]])


def test_numbers_are_taken_from_the_side_of_each_state(meter):
    assert merge(meter, FIRST, 1.0, 2.0).tolist() == [[1.0, 2.0]]


def test_a_constant_that_both_sides_agree_on_stays_a_constant(meter):
    assert merge(meter, FIRST, 3, 3) == 3
    assert merge(meter, FIRST, "a", "a") == "a"
    assert isinstance(merge(meter, FIRST, 3, 3.0), np.ndarray)


def test_one_value_of_both_sides_stays_itself(meter):
    vector = np.ones((2, 1, 1))
    assert merge(meter, FIRST, vector, vector) is vector


def test_vectors_are_joined_entry_by_entry(meter):
    found = merge(meter, FIRST, np.array([[[1.0]], [[2.0]]]), np.array([[[3.0]], [[4.0]]]))
    assert found.tolist() == [[[1.0, 3.0]], [[2.0, 4.0]]]


@pytest.mark.parametrize(("a", "b"), [(1.0, None), ("a", "b"), ([1.0], [1.0, 2.0]), ([], ())])
def test_what_cannot_be_joined_becomes_a_value_that_cannot_be_read(a, b, meter):
    assert isinstance(merge(meter, FIRST, a, b), Poison)


def test_a_variable_of_one_branch_is_set_in_its_states_only(meter):
    found = merge_variables(meter, FIRST, {"x": 1.0, "only": 5.0}, {"x": 2.0, "other": 6.0})
    assert list(found) == ["x", "only", "other"]
    assert found["only"].mask.tolist() == [[True, False]]
    assert found["other"].mask.tolist() == [[False, True]]


def test_a_key_of_one_branch_is_filled_in_the_other_states(meter):
    found = merge(meter, FIRST, {"touch": 4.0}, {})
    assert filled(meter, found["touch"], 0.0).tolist() == [[4.0, 0.0]]
    assert filled(meter, 7.0, 0.0) == 7.0


def test_a_value_set_in_both_branches_is_set_where_either_was(meter):
    found = merge(meter, FIRST, Partial(1.0, np.array([[True, True]])), Partial(2.0, np.array([[True, False]])))
    assert found.mask.tolist() == [[True, False]]
    assert found.value.tolist() == [[1.0, 2.0]]
    assert isinstance(merge(meter, FIRST, Partial(1.0, FIRST), "a"), Poison)
    whole = merge(meter, FIRST, 1.0, Partial(2.0, np.array([[False, True]])))
    assert whole.mask.tolist() == [[True, True]]
