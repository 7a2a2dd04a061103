"""Arrays and lists follow the rules of Python and NumPy for one state."""

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.arithmetic import as_vector, binary, dot, elementwise, negative, norm
from coral.contact.cost_program.values import Seq, Vec


def test_a_power_of_constants_is_exact_or_refused(meter):
    assert binary(meter, "**", 3, 4) == 81
    assert binary(meter, "**", 2.0, -1) == 0.5
    for base, exponent in ((10.0, 400), (-8.0, 0.5)):
        with pytest.raises(CostError) as caught:
            binary(meter, "**", base, exponent)
        assert caught.value.code == "too_large_number"


def test_vectors_of_different_lengths_do_not_match_unless_one_has_one_entry(meter):
    assert binary(meter, "+", Vec((1.0,)), Vec((1.0, 2.0))).items == (2.0, 3.0)
    with pytest.raises(CostError, match="a vector of 2 and a vector of 3") as caught:
        binary(meter, "+", Vec((1.0, 2.0)), Vec((1.0, 2.0, 3.0)))
    assert caught.value.code == "wrong_size"


def test_lists_are_joined_as_in_python_not_added_by_entries(meter):
    assert binary(meter, "+", Seq((1, 2)), Seq((3,))).items == (1, 2, 3)
    with pytest.raises(CostError, match=r"np\.array"):
        binary(meter, "-", Seq((1, 2)), Seq((3, 4)))


def test_texts_are_compared_for_equality_only(meter):
    assert binary(meter, "==", "a", "a") is True
    assert binary(meter, "!=", "a", "b") is True
    with pytest.raises(CostError, match="`<` does not apply to a text and a text"):
        binary(meter, "<", "a", "b")


def test_an_array_has_one_axis_and_at_least_one_entry(meter):
    for items, words in (((Seq((1.0,)), 2.0), "one axis"), ((), "at least one entry")):
        with pytest.raises(CostError, match=words):
            as_vector(meter, Seq(items))


def test_a_product_of_vectors_of_different_lengths_is_refused(meter):
    with pytest.raises(CostError) as caught:
        dot(meter, Vec((1.0, 2.0)), Vec((1.0, 2.0, 3.0)))
    assert caught.value.code == "wrong_size"


def test_the_length_of_a_vector_of_arrays_is_taken_state_by_state(meter):
    assert norm(meter, Vec((np.array([[3.0, 0.0]]), np.array([[4.0, 2.0]])))).tolist() == [[5.0, 2.0]]


def test_a_pairwise_function_meets_every_pair_in_order(meter):
    found = elementwise(meter, lambda x, y: (x, y), Vec((1.0, 2.0)), 5.0)
    assert found.items == ((1.0, 5.0), (2.0, 5.0))
    assert negative(meter, Vec((1.0, -2.0))).items == (-1.0, 2.0)
