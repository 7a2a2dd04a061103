"""Statistics of vectors agree with NumPy, state by state."""

import numpy as np
import pytest

from coral.contact.cost_program.statistics import in_order

SAME = {
    "std and var": "return np.std(self.ee_pos) + self.box_pos.var(ddof=1) + np.std(np.eye(3), axis=0)[1]",
    "average with weights": (
        "return np.average(self.ee_pos, weights=[1.0, 2.0, self.time + 0.1]) + np.average(self.ee_pos)\n"
    ),
    "interp": "return np.interp(self.time, [0.0, 0.3, 0.6], [0, 2.0, 1.0]) + np.interp(self.ee_pos, [0, 1], [0, 1])[0]",
    "select": "d = self.time\nreturn np.select([d < 0.3, d < 0.6], [d, 2.0 * d], default=-1.0)",
    "select of vectors": "v = self.ee_pos\nreturn np.sum(np.select([v > 0.1, v > 0.0], [v, 2.0 * v], 3.0))",
    "sorted": "a, b, c = sorted(self.ee_pos)\nreturn a + 10.0 * b + 100.0 * c + sorted([3, 1, 2], reverse=True)[0]",
    "sorted keys": "d = {'b': self.time, 'a': 2.0}\nreturn sum(d[k] * (i + 1) for i, k in enumerate(sorted(d)))",
    "median and sort": "return np.median(self.ee_pos) + np.median(self.box_quat) + np.sort(self.ee_pos)[0]",
    "hypot of three": "return math.hypot(*self.ee_pos) + math.hypot(self.time, 1.0) + math.hypot(-2.0)",
    "cumsum and diff": "return np.cumsum(self.ee_pos)[1] + np.diff(self.box_pos)[1]",
    "arange and linspace": "return np.dot(np.arange(3), self.ee_pos) + np.dot(np.linspace(0, 1, 3), self.box_pos)",
    "arange with a step": "return np.sum(np.arange(0.5, 2.0, 0.25)) + len(np.arange(5, 0, -2)) + self.time",
}
REFUSED = {
    "interp between moving points": (
        "return np.interp(0.1, [0, 1], [0, self.time])",
        "not_fixed",
        "straight line",
    ),
    "axis of a number": ("return np.var(self.time, axis=0)", "wrong_size", "no axis 0"),
    "moving axis": ("return np.average(self.ee_pos, self.time)", "wrong_call", "along an axis"),
    "spread of one number": ("return np.var([self.time], ddof=1)", "wrong_size", "the spread of 1 numbers"),
    "weights of another length": ("return np.average(self.ee_pos, weights=[1.0])", "wrong_size", "1 weights for 3"),
    "conditions without choices": ("return np.select([self.time > 0.5], [])", "wrong_size", "1 conditions and 0"),
    "moving points": ("return np.sum(np.linspace(0.0, self.time, 3))", "not_fixed", "constant numbers"),
    "arange without a step": ("return np.sum(np.arange(0, 1, 0))", "wrong_call", "the step not 0"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_statistic_gives_what_numpy_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_a_statistic_that_does_not_exist_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found


def test_numbers_are_put_in_order_in_each_state_on_its_own(meter):
    found = in_order(meter, (np.array([[3.0, 1.0]]), 2, np.array([[1.0, 9.0]])))
    assert [item.tolist() for item in found] == [[[1.0, 1.0]], [[2.0, 2.0]], [[3.0, 9.0]]]
