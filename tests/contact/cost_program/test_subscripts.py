"""Reading entries gives what NumPy and Python give, and an index never depends on the state."""

import pytest

SAME = {
    "slices and steps": "v = self.box_quat\nreturn v[1:][0] + 10.0 * v[::-2][1] + 100.0 * v[-1]",
    "keys": "d = {'a': self.time, 2: 3.0}\nreturn d['a'] + d[2]",
    "slice of a list": "L = [self.time, 2.0, 3.0]\nreturn L[:2][0] + len(L[1:]) + (1.0, 2.0)[-1]",
    "vectors in a list": "L = [self.ee_pos, self.box_pos]\nreturn L[1][2] + 10.0 * L[0][0]",
}
REFUSED = {
    "slice of a dict": ("d = {'a': 1.0}\nreturn d[:2]", "not_allowed", "a slice is an index"),
    "two axes": ("return self.ee_pos[0, 1]", "wrong_type", "one axis"),
    "axes of a number": ("return self.time[0]", "wrong_type", "no numbered entries"),
    "unknown key": ("d = {'a': 1.0}\nreturn d['b']", "wrong_size", "it has 'a'"),
    "entry before the first": ("return self.ee_pos[-4]", "wrong_size", "no entry -4"),
    "truth value as an index": ("return self.ee_pos[True]", "not_fixed", "not a truth value"),
    "step of zero": ("return self.ee_pos[::0][0]", "wrong_size", "not 0"),
    "list of indices": ("return self.ee_pos[[0, 1]][0]", "not_fixed", "a constant whole number"),
    "numbered values": ("d = {'a': 1.0}\nreturn d.values()[0]", "wrong_type", "no numbered entries"),
    "text as an index": ("return self.ee_pos['x']", "not_fixed", "not a text"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_an_entry_is_that_of_python(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_an_entry_that_is_not_there_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
