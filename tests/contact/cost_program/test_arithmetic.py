"""Arrays and lists follow the rules of Python and NumPy for one state."""

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.arithmetic import as_vector, binary, dot, elementwise, negative, norm, transposed
from coral.contact.cost_program.values import Seq, Vec

YES_NO = np.array([[True, False]])


def test_a_power_of_constants_is_exact_or_refused(meter):
    assert binary(meter, "**", 3, 4) == 81
    assert binary(meter, "**", 2.0, -1) == 0.5
    for base, exponent in ((10.0, 400), (-8.0, 0.5)):
        with pytest.raises(CostError) as caught:
            binary(meter, "**", base, exponent)
        assert caught.value.code == "too_large_number"


def test_a_vector_and_a_matrix_are_broadcast_row_by_row(meter):
    matrix = Vec((Vec((1.0, 2.0)), Vec((3.0, 4.0))))
    found = binary(meter, "-", matrix, Vec((1.0, 10.0)))
    assert [row.items for row in found.items] == [(0.0, -8.0), (2.0, -6.0)]


def test_vectors_of_different_lengths_do_not_match_unless_one_has_one_entry(meter):
    assert binary(meter, "+", Vec((1.0,)), Vec((1.0, 2.0))).items == (2.0, 3.0)
    with pytest.raises(CostError, match="a vector of 2 and a vector of 3") as caught:
        binary(meter, "+", Vec((1.0, 2.0)), Vec((1.0, 2.0, 3.0)))
    assert caught.value.code == "wrong_size"


def test_lists_are_joined_and_repeated_as_in_python_not_added_by_entries(meter):
    assert binary(meter, "+", Seq((1, 2)), Seq((3,))).items == (1, 2, 3)
    assert binary(meter, "*", 2, Seq((1, 2), "tuple")).items == (1, 2, 1, 2)
    with pytest.raises(CostError, match=r"np\.array"):
        binary(meter, "-", Seq((1, 2)), Seq((3, 4)))


def test_texts_and_none_are_compared_for_equality_only(meter):
    assert binary(meter, "==", "a", "a") is True
    assert binary(meter, "!=", "a", "b") is True
    assert binary(meter, "==", None, 1.0) is False
    with pytest.raises(CostError, match="`<` does not apply to a text and a text"):
        binary(meter, "<", "a", "b")


def test_a_plain_vector_has_no_columns_to_swap(meter):
    vector = Vec((1.0, 2.0))
    assert transposed(meter, vector) is vector
    swapped = transposed(meter, Vec((Vec((1.0, 2.0)), Vec((3.0, 4.0)))))
    assert [row.items for row in swapped.items] == [(1.0, 3.0), (2.0, 4.0)]


def test_rows_of_different_lengths_make_no_array(meter):
    with pytest.raises(CostError, match="one length"):
        as_vector(meter, Seq((Seq((1.0,)), Seq((1.0, 2.0)))))


def test_products_of_matrices_and_vectors_are_those_of_numpy(agrees):
    agrees("""
        m = np.array([[1.0, self.time, 2.0], [0.5, -1.0, self.gripper_opening]])
        v = m @ self.ee_pos
        n = m @ m.T
        return v[0] + 2.0 * v[1] + n[0, 1] + (self.ee_pos @ m.T)[1]
    """)


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


def test_an_array_of_matrices_is_refused(refusal):
    assert "one or two axes" in refusal("return np.sum(np.eye(2) * [np.eye(2), np.eye(2)])").text
