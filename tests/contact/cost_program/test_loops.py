"""Loops run as in Python, though some states leave them earlier than others."""

import pytest

SAME = {
    "break in some states": (
        "s = 0.0\nfor x in [0.2, 0.4, 0.6]:\n    if s > self.time:\n        break\n    s += x\nreturn s + x"
    ),
    "continue in some states": (
        "s = 0.0\nfor i, x in enumerate(self.ee_pos):\n    if x < 0.0:\n        continue\n    s += i + x\nreturn s"
    ),
    "break of an inner loop": (
        "s = 0.0\nfor i in range(3):\n    for j in range(3):\n        if j * 0.3 > self.time:\n            break\n"
        "        s += 1.0 + j\n    s += 10.0\nreturn s"
    ),
    "break in a helper leaves the caller's loop alone": (
        "def f(x):\n    for i in range(4):\n        if x < 0.25 * i:\n            break\n    return i\n"
        "s = 0.0\nfor k in range(2):\n    s += f(self.time) * (k + 1)\nreturn s"
    ),
    "loop over nothing": "s = self.time\nfor x in []:\n    s = 5.0\nreturn s",
    "return out of a loop": (
        "for i in range(4):\n    if self.time < 0.25 * (i + 1):\n        return i + self.time\nreturn 9.0"
    ),
}
REFUSED = {
    "long list": ("s = 0.0\nfor x in [1.0] * 65:\n    s += x\nreturn s", "steps", "at most 64 turns"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_loop_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_a_loop_without_a_fixed_end_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
