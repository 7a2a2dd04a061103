"""Arrays are made and joined as by NumPy."""

import pytest

from coral.contact.cost_program.arrays import array
from coral.contact.cost_program.values import Seq

SAME = {
    "array of floats by its type": "v = np.array([0, 1], dtype=float)\nreturn v[1] / 3 + self.time",
    "asarray of an array": "return np.asarray(self.ee_pos)[1] + np.array(self.ee_pos.copy())[2]",
    "concatenate": "m = np.concatenate([self.ee_vel, np.zeros(2), [1.0]])\nreturn np.sum(m) + m[5]",
    "append a number": "v = np.append(self.ee_pos[:2], 0.12)\nreturn np.sum(v) + v[2]",
    "append a vector": "v = np.append(self.ee_pos, self.ee_vel)\nreturn np.sum(v) + v[5]",
    "ones": "return np.dot(np.ones(3), self.ee_pos)",
    "whole numbers": "v = np.array([3, 2])\nreturn v[0] // v[1] + self.time",
}
REFUSED = {
    "other types": ("return np.array([0.0, 1.0], dtype=int)[0]", "float64 only"),
    "two axes": ("return np.zeros((2, 2))[0][0]", "an array has one axis"),
    "rows": ("return np.array([self.ee_pos, self.box_pos])[0][0]", "write a list of vectors"),
    "stack": ("return np.stack([self.ee_pos, self.box_pos])[0][0]", "write a list of vectors"),
    "no entries": ("return np.sum(self.ee_pos[3:])", "at least one entry"),
    "a number": ("return np.array(self.time)", "takes a vector"),
    "a list of numbers": ("return np.concatenate([1.0, 2.0])[0]", "a vector is needed here, not a number"),
    "nothing to join": ("return np.concatenate([])[0]", "a list of arrays"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_new_array_has_the_entries_of_numpys(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_what_numpy_would_hold_in_another_way_is_refused(case, refusal):
    body, words = REFUSED[case]
    assert words in refusal(body).text


def test_one_float_makes_all_entries_of_an_array_floats(meter):
    assert all(isinstance(item, float) for item in array(meter, Seq((1, 2.5))).items)
