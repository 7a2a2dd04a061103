"""Values are bound to names as in Python; what cannot be kept is refused."""

import pytest

SAME = {
    "tuple": "a, b, c = self.ee_pos\nreturn a + 10.0 * b + 100.0 * c",
    "nested tuple": "(a, b), c = [[1.0, self.time], 3.0]\nreturn a + 10.0 * b + 100.0 * c",
    "swap": "a, b = 1.0, self.time\na, b = b, a\nreturn a + 10.0 * b",
    "loop over pairs": "s = 0.0\nfor k, v in enumerate(self.ee_pos):\n    s = s + k * v\nreturn s",
    "text and whole number as keys": "d = {'a': self.time, 2: 3.0}\nreturn d['a'] + d[2]",
}
REFUSED = {
    "generator kept": ("k = 1.0\ng = (k * x for x in [1.0])\nk = 5.0\nreturn sum(g)", "wrong_type", "write list(...)"),
    "state as a key": ("d = {self.time: 1.0}\nreturn 1.0", "not_fixed", "constant texts or whole numbers"),
    "too few names": ("a, b = self.ee_pos\nreturn a", "wrong_size", "2 names cannot take 3 values"),
    "starred": ("a, *b = self.ee_pos\nreturn a", "not_allowed", "one by one"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_names_take_what_python_gives_them(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_what_cannot_be_bound_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert found.code == code
    assert words in str(found)
