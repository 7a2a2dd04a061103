"""Reductions run over all entries or along an axis, as NumPy's do."""

import pytest

SAME = {
    "keepdims": (
        "m = np.stack([self.ee_pos, self.box_pos])\nu = m / np.linalg.norm(m, axis=1, keepdims=True)\n"
        "c = m - m.mean(axis=0, keepdims=True)\nreturn u[0, 0] + c[1, 2] + m.sum(keepdims=True)[0, 0]"
    ),
    "norms of a matrix": (
        "m = np.stack([self.ee_pos, self.box_pos])\n"
        "return np.linalg.norm(m) + np.linalg.norm(m, axis=0)[1] + np.linalg.norm(m, 1, axis=1)[0]"
    ),
    "norms of a vector": (
        "v = self.ee_pos\nreturn np.linalg.norm(v, 1) + np.linalg.norm(v, ord=np.inf) + np.linalg.norm(v, 2)"
    ),
    "reductions along an axis": (
        "m = np.stack([self.ee_pos, self.box_pos])\n"
        "return m.max(axis=0)[2] + m.min(axis=1)[1] + np.prod(m, axis=-1)[0] + np.mean(m) + np.any(m > 0.3) * 5.0"
    ),
    "truth values counted": "return np.sum(self.ee_pos > 0.0) + np.mean(self.ee_pos > 0.1)",
}
REFUSED = {
    "order of a norm of a matrix": ("return np.linalg.norm(np.eye(2) * self.time, 1)", "wrong_call", "give it an axis"),
    "moving order of a norm": ("return np.linalg.norm(self.ee_pos, self.time)", "wrong_call", "ord 1, 2"),
    "axis of a number": ("return np.sum(self.time, axis=0)", "wrong_size", "no axis 0"),
    "axis that is not there": ("return np.sum(self.ee_pos, axis=1)", "wrong_size", "a vector of 3 has no axis 1"),
    "largest of truth values": ("return np.max(self.ee_pos > 0.0)", "wrong_type", "write float"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_reduction_gives_what_numpy_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_what_numpy_reduces_in_another_way_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
