"""Arrays are made, joined and reshaped as by NumPy."""

import math

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.arrays import (
    array,
    as_type,
    concatenate,
    diag,
    eye,
    full,
    reshape,
    shape_of,
    squeezed,
    to_float,
    to_int,
    to_list,
)
from coral.contact.cost_program.values import Seq, Vec

SAME = {
    "array of floats by its type": "v = np.array([0, 0], dtype=float)\nv[1] = 0.5\nreturn v[1]",
    "append": "a = np.zeros(2)\nm = np.append(a, self.time)\na[0] = 3.0\nreturn np.sum(m) + len(np.append(m, [a, a]))",
    "concatenate": "a = np.zeros(2)\nm = np.concatenate([a, a])\na[0] = 3.0\nreturn np.sum(m) + a[0]",
    "flatten": "m = np.zeros((2, 2))\nv = m.flatten()\nv[0] = 3.0\nreturn np.sum(m) + v[0]",
    "rows of a stack": "a, b = np.zeros(2), np.ones(2)\nm = np.stack([a, b])\na[0] = 3.0\nreturn np.sum(m) + a[0]",
    "rows of zeros": "m = np.zeros((2, 3))\nm[0][1] = 4.0\nm[1, 2] = 5.0\nreturn np.sum(m[0]) + 10.0 * np.sum(m[1])",
    "stack of columns": "m = np.stack([self.ee_pos, self.box_pos], axis=1)\nreturn m[2, 0] + 3.0 * m[0, 1] + len(m)",
    "tolist": "m = np.ones((2, 2))\nL = m.tolist()\nL[0][0] = 3.0\nreturn np.sum(m) + L[0][0] + len(L + [1.0])",
    "zeros and ones like": (
        "v = np.array([2, 3])\nz = np.zeros_like(v)\nz[0] = 4\n"
        "return np.dot(z + np.ones_like(self.ee_pos[:2]), v) + self.time"
    ),
}
VIEWS = {
    "array without a copy": "v = np.zeros(2)\nw = np.array(v, copy=False)\nw[0] = 1.0\nreturn v[0]",
    "asarray": "v = np.zeros(2)\nw = np.asarray(v)\nw[0] = 1.0\nreturn v[0]",
    "ravel": "m = np.zeros((2, 2))\nv = m.ravel()\nv[0] = 1.0\nreturn m[0, 0]",
    "reshape": "v = np.zeros(4)\nm = v.reshape(2, 2)\nm[0, 0] = 1.0\nreturn v[0]",
    "squeeze": "m = np.zeros((1, 2))\nw = m.squeeze()\nw[0] = 1.0\nreturn m[0, 0]",
    "transpose": "m = np.zeros((2, 2))\nt = m.T\nt[0, 1] = 1.0\nreturn m[1, 0]",
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_new_array_has_memory_and_entries_as_in_numpy(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(VIEWS))
def test_a_view_shares_its_memory_with_the_array(case, refusal):
    assert refusal(VIEWS[case]).code == "shared"


def test_one_float_makes_all_entries_of_an_array_floats(meter):
    assert all(isinstance(item, float) for item in array(meter, Seq((1, 2.5))).items)
    assert all(isinstance(item, int) for item in array(meter, Seq((1, 2))).items)


@pytest.mark.parametrize("shape", [(6,), (2, 3), (3, -1), (-1,)])
def test_a_reshaped_array_has_the_shape_and_order_of_numpy(shape, meter):
    wanted = np.arange(6.0).reshape(shape)
    found = reshape(meter, Vec(tuple(range(6))), *shape)
    assert tuple(shape_of(found).items) == wanted.shape
    assert [list(row.items) if isinstance(row, Vec) else row for row in found.items] == wanted.tolist()


@pytest.mark.parametrize("shape", [(4,), (4, -1), (0, 6), (1, 2, 3)])
def test_numbers_that_do_not_fill_a_shape_are_refused(shape, meter):
    with pytest.raises(CostError) as caught:
        reshape(meter, Vec((0.0,) * 6), *shape)
    assert caught.value.code == "wrong_size"


def test_a_conversion_to_a_whole_number_drops_the_decimals(meter):
    assert to_int(meter, -3.7) == -3
    assert to_int(meter, np.array([[-1.5, 2.9]])).tolist() == [[-1.0, 2.0]]
    with pytest.raises(CostError, match="finite"):
        to_int(meter, math.inf)


def test_the_text_of_infinity_is_a_number_and_other_texts_are_not(meter):
    assert to_float(meter, "inf") == math.inf
    assert to_float(meter, " -Infinity ") == -math.inf
    with pytest.raises(CostError, match="float takes a number"):
        to_float(meter, "1.5")


@pytest.mark.parametrize("make", [lambda m: full(m, Seq((64, 64), "tuple"), 0.0), lambda m: eye(m, 9)])
def test_an_array_that_is_too_large_is_refused(make, meter):
    with pytest.raises(CostError) as caught:
        make(meter)
    assert caught.value.code == "wrong_size"


def test_a_size_that_depends_on_the_state_is_refused(refusal):
    assert refusal("return np.sum(np.zeros(self.current_step))").code == "not_fixed"


def test_a_diagonal_of_a_diagonal_matrix_is_the_vector(meter):
    matrix = diag(meter, Vec((1.0, 2.0)))
    assert [row.items for row in matrix.items] == [(1.0, 0.0), (0.0, 2.0)]
    assert diag(meter, matrix).items == (1.0, 2.0)


def test_vectors_and_numbers_are_concatenated_in_order(meter):
    assert concatenate(meter, Seq((Seq((1.0, 2.0)), Vec((3.0,))))).items == (1.0, 2.0, 3.0)


def test_a_column_of_one_number_each_is_squeezed_to_a_vector(meter):
    assert squeezed(meter, Vec((Vec((1.0,)), Vec((2.0,))))).items == (1.0, 2.0)
    with pytest.raises(CostError, match="write its entry"):
        squeezed(meter, Vec((1.0,)))


def test_a_matrix_becomes_a_list_of_lists(meter):
    found = to_list(meter, Vec((Vec((1.0, 2.0)), Vec((3.0, 4.0)))))
    assert found.kind == "list"
    assert [row.items for row in found.items] == [(1.0, 2.0), (3.0, 4.0)]


def test_whole_numbers_become_floats_by_astype(meter):
    found = as_type(meter, Vec((1, True)))
    assert found.items == (1.0, 1.0)
    assert all(isinstance(item, float) for item in found.items)
