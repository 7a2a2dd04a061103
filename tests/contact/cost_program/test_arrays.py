"""Arrays are made, joined and reshaped as by NumPy."""

import pytest

from coral.contact.cost_program.arrays import arranged, array, flat, places, shape
from coral.contact.cost_program.values import Seq, Vec

SAME = {
    "array of floats by its type": "v = np.array([0, 0], dtype=float)\nv[1] = 0.5\nreturn v[1] + self.time",
    "concatenate": "a = np.zeros(2)\nm = np.concatenate([a, a])\na[0] = 3.0\nreturn np.sum(m) + a[0]",
    "concatenated along the last axis": (
        "m = np.stack([self.ee_pos, self.box_pos])\nn = np.concatenate([m, m], axis=-1)\n"
        "return n[0, 4] + np.hstack([m, m])[1, 5]"
    ),
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
    "asarray": "v = np.zeros(2)\nw = np.asarray(v)\nw[0] = 1.0\nreturn v[0]",
    "ravel": "m = np.zeros((2, 2))\nv = m.ravel()\nv[0] = 1.0\nreturn m[0, 0]",
    "reshape": "v = np.zeros(4)\nm = v.reshape(2, 2)\nm[0, 0] = 1.0\nreturn v[0]",
    "transpose": "m = np.zeros((2, 2))\nt = m.T\nt[0, 1] = 1.0\nreturn m[1, 0]",
    "number of np.where": "x = np.where(self.time > 0.5, 1.0, 2.0)\ny = x\ny += 1.0\nreturn x",
}
REFUSED = {
    "whole numbers that would lose decimals": (
        "a = np.square(np.array([1, 2]))\na[0] = 0.5\nreturn a[0]",
        "0.0, not 0",
    ),
    "whole numbers of the state": ("a = np.array([int(self.time), 1])\na[0] = 0.5\nreturn a[0]", "0.0, not 0"),
    "other types": ("return np.zeros(2, dtype='float32')[0]", "float64 only"),
    "three axes": ("return np.zeros((2, 2, 2))[0][0][0]", "one or two axes"),
    "no entries": ("return np.sum(self.ee_pos[3:])", "at least one entry"),
    "a number": ("return np.array(self.time)", "takes a vector or matrix"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_new_array_has_memory_and_entries_as_in_numpy(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(VIEWS))
def test_a_view_shares_its_memory_with_the_array(case, refusal):
    assert refusal(VIEWS[case]).code == "shared"


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_what_numpy_would_hold_in_another_way_is_refused(case, refusal):
    body, words = REFUSED[case]
    assert words in refusal(body).text


def test_one_float_makes_all_entries_of_an_array_floats(meter):
    assert all(isinstance(item, float) for item in array(meter, Seq((1, 2.5))).items)


def test_numpy_moves_the_entries_by_their_numbers(meter):
    matrix = Vec((Vec(("a", "b", "c")), Vec(("d", "e", "f"))))
    assert (shape(matrix), flat(matrix)[4], places(matrix)[1, 2]) == ((2, 3), "e", 5)
    assert arranged(meter, lambda x: x.T[1], matrix).items == ("b", "e")
