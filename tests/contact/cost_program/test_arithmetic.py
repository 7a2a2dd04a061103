"""Numbers, vectors and lists follow the rules of Python and NumPy for one state."""

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.arithmetic import as_vector, binary, dot, no_truth, norm, numeric, truth, where

YES_NO = np.array([[True, False]])


def vector(*items):
    return np.array(items).reshape(-1, 1, 1)


def test_a_power_of_constants_is_exact_or_refused(meter):
    assert binary(meter, "**", 3, 4) == 81
    assert binary(meter, "**", 2.0, -1) == 0.5
    for base, exponent in ((10.0, 400), (-8.0, 0.5), (3, 10_000)):
        with pytest.raises(CostError) as caught:
            binary(meter, "**", base, exponent)
        assert caught.value.code == "too_large_number"


def test_whole_numbers_end_where_arrays_stop_holding_them_exactly(meter):
    assert binary(meter, "-", 2**53, 1) == 2**53 - 1
    with pytest.raises(CostError) as caught:
        binary(meter, "+", 2**53, 1)
    assert caught.value.code == "too_large_number"


@pytest.mark.parametrize("symbol", ["/", "//", "%"])
def test_a_division_of_constants_by_zero_is_refused_but_not_one_by_the_state(symbol, meter):
    with pytest.raises(CostError) as caught:
        binary(meter, symbol, 1.0, 0)
    assert caught.value.code == "division_by_zero"
    with np.errstate(all="ignore"):
        assert binary(meter, symbol, 1.0, np.array([[2.0, 0.0]])).shape == (1, 2)


def test_vectors_of_different_lengths_do_not_match_unless_one_has_one_entry(meter):
    assert binary(meter, "+", vector(1.0), vector(1.0, 2.0)).ravel().tolist() == [2.0, 3.0]
    with pytest.raises(CostError, match="a vector of 2 and a vector of 3") as caught:
        binary(meter, "+", vector(1.0, 2.0), vector(1.0, 2.0, 3.0))
    assert caught.value.code == "wrong_size"


def test_a_number_of_every_state_meets_every_entry_of_a_vector(meter):
    found = binary(meter, "*", np.array([[1.0, 2.0]]), vector(1.0, 2.0, 3.0))
    assert found.tolist() == [[[1.0, 2.0]], [[2.0, 4.0]], [[3.0, 6.0]]]


def test_lists_are_joined_as_in_python_not_added_by_entries(meter):
    assert binary(meter, "+", [1, 2], [3]) == [1, 2, 3]
    with pytest.raises(CostError, match=r"np\.array"):
        binary(meter, "-", [1, 2], [3, 4])


def test_texts_are_compared_for_equality_only(meter):
    assert binary(meter, "==", "a", "a") is True
    assert binary(meter, "!=", "a", "b") is True
    with pytest.raises(CostError, match="`<` does not apply to a text and a text"):
        binary(meter, "<", "a", "b")


def test_an_array_has_one_axis_and_at_least_one_entry(meter):
    for items, words in (([[1.0], 2.0], "one axis"), ([], "at least one entry")):
        with pytest.raises(CostError, match=words):
            as_vector(meter, items)


def test_a_vector_of_constants_has_one_state_and_one_of_the_state_has_all(meter):
    assert as_vector(meter, [1, 2.5]).shape == (2, 1, 1)
    assert as_vector(meter, [1, YES_NO]).tolist() == [[[1.0, 1.0]], [[1.0, 0.0]]]
    assert as_vector(meter, [True, YES_NO]).dtype == np.bool_


def test_a_product_of_vectors_of_different_lengths_is_refused(meter):
    with pytest.raises(CostError) as caught:
        dot(meter, vector(1.0, 2.0), vector(1.0, 2.0, 3.0))
    assert caught.value.code == "wrong_size"


def test_the_length_of_a_vector_is_taken_state_by_state(meter):
    assert norm(meter, [np.array([[3.0, 0.0]]), np.array([[4.0, 2.0]])]).tolist() == [[5.0, 2.0]]


def test_truth_values_count_as_zero_and_one_where_that_is_what_numpy_does(meter):
    assert numeric(meter, True) == 1
    assert numeric(meter, YES_NO).tolist() == [[1.0, 0.0]]
    with pytest.raises(CostError, match="write float"):
        no_truth(meter, YES_NO)


def test_a_choice_between_truth_values_stays_a_truth_value(meter):
    assert where(meter, YES_NO, True, False).dtype == np.bool_
    assert where(meter, YES_NO, 1, False).dtype == np.float64


def test_a_vector_is_neither_true_nor_false(meter):
    assert truth(meter, np.array([[0.0, 2.0]])).tolist() == [[False, True]]
    with pytest.raises(CostError, match=r"np\.any or np\.all"):
        truth(meter, vector(1.0, 2.0))


def test_a_sum_of_truth_values_of_the_state_is_refused(refusal):
    assert "write float" in refusal("return (self.time > 0.5) + (self.time > 0.2)").text


@pytest.mark.parametrize("number", ["z", "np.sqrt(z)", "float(z)", "np.where(z > 0.0, 1.0, 0.0)"])
def test_a_division_by_zero_in_some_state_is_infinite_there(number, terms):
    found = terms(f"z = 0.0 * self.time\nreturn np.tanh(1.0 / ({number}))")
    assert (found["cost"] == 1.0).all()
