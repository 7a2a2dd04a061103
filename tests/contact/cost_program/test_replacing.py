"""Assigning to entries gives the array or list that Python gives."""

import pytest

SAME = {
    "new axis": "v = np.zeros(3)\nv[None] = self.time\nreturn np.sum(v)",
    "column": (
        "m = np.zeros((2, 3))\nm[:, 1] = [1.0, self.time]\nm[1:, 2] = 4.0\nreturn m[1, 1] + 10.0 * m[1, 2] + m[0, 2]"
    ),
    "in place on a slice": "v = np.array([0.0, 1.0, 2.0, 3.0])\nv[1:3] *= 10.0\nreturn v[1] + v[2] + 100.0 * v[3]",
    "row of a matrix that was set": (
        "m, v = np.zeros((2, 2)), np.ones(2)\nm[0] = v\nv[0] = 9.0\nreturn np.sum(m) + v[0]"
    ),
    "negative index and step": "v = np.zeros(4)\nv[-1] = self.time\nv[::2] = [1.0, 2.0]\nreturn v[0] + v[2] * v[3]",
    "list of indices": "v = np.zeros(4)\nv[[3, 0]] = [self.time, 2.0]\nreturn v[0] + 10.0 * v[3]",
    "ellipsis": "m = np.zeros((2, 2))\nm[..., 0] = self.time\nreturn np.sum(m) + m[1, 0]",
    "row for all rows": "m = np.zeros((2, 3))\nm[:] = self.ee_pos\nreturn m[0, 1] + m[1, 2]",
    "one value for several": "v = np.zeros(3)\nv[1:] = [self.time]\nreturn v[0] + v[1] + 10.0 * v[2]",
    "new key": "d = {'a': 1.0}\nd['b'] = self.time\nd['a'] = 3.0\nreturn d['a'] + d['b'] + len(d)",
}
REFUSED = {
    "whole numbers": ("v = np.array([0, 0, 0])\nv[2] = 0.7\nreturn v[2]", "wrong_type", "begin with 0.0, not 0"),
    "whole numbers in place": ("v = np.array([1, 2])\nv += self.time\nreturn v[0]", "wrong_type", "begin with 0.0"),
    "shape in place": ("v = np.zeros(2)\nv += np.zeros((2, 2))\nreturn np.sum(v)", "wrong_size", "write v = v + w"),
    "truth values": (
        "v = np.array([True, False])\nv[0] = 0.5\nreturn 1.0 * v[0]",
        "wrong_type",
        "begin with an array of 0.0",
    ),
    "truth values of the state": (
        "v = self.ee_pos > 0.0\nv[0] = 0.5\nreturn 1.0 * v[0]",
        "wrong_type",
        "begin with an array of 0.0",
    ),
    "entry outside": ("v = np.zeros(2)\nv[2] = 1.0\nreturn v[0]", "wrong_size", "no entry 2"),
    "too few values": ("v = np.zeros(3)\nv[:] = [1.0, 2.0]\nreturn v[0]", "wrong_size", "does not fit there"),
    "list that would grow": ("L = [1.0, 2.0]\nL[1:] = [1.0, 2.0]\nreturn L[0]", "wrong_type", "set one by one"),
    "tuple": ("t = (1.0, 2.0)\nt[0] = 3.0\nreturn t[0]", "wrong_type", "a tuple of 2 cannot be set"),
    "number": ("x = self.time + 0.0\nx[0] = 3.0\nreturn x", "wrong_type", "a number cannot be set"),
    "index of the state": ("v = np.zeros(3)\nv[self.current_step] = 1.0\nreturn v[0]", "not_fixed", "np.where"),
    "key of the state": ("d = {}\nd[self.time] = 1.0\nreturn 1.0", "not_fixed", "a constant text"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_set_entry_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_an_entry_that_cannot_be_set_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
