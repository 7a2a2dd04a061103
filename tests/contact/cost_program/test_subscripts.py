"""Reading entries gives what NumPy and Python give, and an index never depends on the state."""

import pytest

SAME = {
    "new axis": "a = self.ee_pos[np.newaxis, :]\nb = self.box_pos[:, None]\nreturn np.sum(np.abs(a - b)) + a.shape[0]",
    "new axis in front": "return np.sum(self.ee_pos[None] * np.ones((2, 3)))",
    "ellipsis": "m = np.stack([self.ee_pos, self.box_pos])\nreturn m[..., 2][1] + m[0, ...][1]",
    "pairs of indices": "m = np.array([[1.0, 2.0], [3.0, 4.0]])\nreturn np.sum(m[[0, 1], [1, 0]])",
    "slices and steps": "v = self.box_quat\nreturn v[1:][0] + 10.0 * v[::-2][1] + 100.0 * v[-1]",
    "rows and columns": (
        "m = np.stack([self.ee_pos, self.box_pos])\n"
        "return m[1][2] + 10.0 * m[:, 0][1] + 100.0 * m[0, 1:][1] + m[::-1][0][0]"
    ),
    "list of indices": "v = self.ee_pos[[2, 0]]\nreturn v[0] + 10.0 * v[1] + len(self.ee_pos[[0, 1, 1]])",
    "keys": "d = {'a': self.time, 2: 3.0}\nreturn d['a'] + d[2]",
    "slice of a list": "L = [self.time, 2.0, 3.0]\nreturn L[:2][0] + len(L[1:]) + (1.0, 2.0)[-1]",
}
REFUSED = {
    "slices of a dict": ("d = {'a': 1.0}\nreturn d[:2, 1:]", "not_allowed", "a slice is an index"),
    "starred index": ("i = [0, 1]\nreturn np.eye(2)[*i]", "not_allowed", "in calls and lists"),
    "array without axes": ("return self.ee_pos[..., 0]", "wrong_type", "leave `...` out"),
    "third axis": ("return np.eye(2)[None][0][0][0]", "wrong_size", "one or two axes"),
    "axes of a number": ("return self.time[:, None]", "wrong_type", "no entries to index"),
    "axes of a list": ("return [1.0, 2.0][:, 0]", "wrong_type", "one axis"),
    "two ellipses": ("return self.ee_pos[..., ...]", "wrong_size", "one axis"),
    "too many axes": ("return np.eye(2)[0, 0, 0]", "wrong_size", "two axes"),
    "unknown key": ("d = {'a': 1.0}\nreturn d['b']", "wrong_size", "it has 'a'"),
    "entry before the first": ("return self.ee_pos[-4]", "wrong_size", "no entry -4"),
    "truth value as an index": ("return self.ee_pos[True]", "not_fixed", "not a truth value"),
    "step of zero": ("return self.ee_pos[::0][0]", "wrong_size", "not 0"),
    "list of indices of a list": ("return [1.0, 2.0][[0, 1]]", "not_fixed", "a constant whole number"),
    "numbered view": ("d = {'a': 1.0}\nreturn d.values()[0]", "wrong_type", "write list(...) around it"),
    "text as an index": ("return self.ee_pos['x']", "not_fixed", "not a text"),
    "pairs that do not match": ("return np.sum(np.eye(3)[[0, 1], [0, 1, 2]])", "wrong_size", "no such entries"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_an_entry_is_that_of_python(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_an_entry_that_is_not_there_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
