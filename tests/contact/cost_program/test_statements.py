"""Statements run as in Python, with both branches of an `if` on the state joined state by state."""

import ast

import pytest

from coral.contact.cost_program.statements import own_names

SAME = {
    "if in an if": (
        "x = 0.0\nif self.time > 0.3:\n    if self.box_hand_contact:\n        x = 1.0\n    else:\n        x = 2.0\n"
        "    x += 10.0\nelif self.time > 0.1:\n    x = 3.0\nreturn x"
    ),
    "return in one branch": "if self.time > 0.5:\n    return 1.0\nx = self.time\nreturn 2.0 * x",
    "return in both branches": (
        "if self.time > 0.5:\n    if self.box_hand_contact:\n        return 1.0\n    else:\n        return 2.0\n"
        "else:\n    return 3.0\nreturn 4.0"
    ),
    "constant condition": "if 1 > 2:\n    return 1.0\nreturn 2.0 + self.time",
    "imports": "import math as m\nimport numpy\nreturn m.sqrt(4.0) + numpy.exp(self.time)",
    "break and continue": (
        "s = 0.0\nfor i, x in enumerate(self.ee_pos):\n    if i == 1:\n        continue\n    s += i + x\n"
        "    for j in range(9):\n        if j == 3:\n            break\n        s += j\nreturn s + j"
    ),
    "loop over nothing": "s = self.time\nfor x in []:\n    s = 5.0\nreturn s",
    "return out of a loop": (
        "for i in range(4):\n    if self.time < 0.25 * (i + 1):\n        return i + self.time\nreturn 9.0"
    ),
    "loop in a branch": (
        "s = 0.0\nif self.time > 0.4:\n    for x in self.ee_pos:\n        s += x\n        break\nreturn s + self.time"
    ),
    "variable of the branch that goes on": (
        "if self.time > 0.5:\n    return 1.0\nelse:\n    y = self.gripper_opening\nreturn y"
    ),
    "text alone": "'A docstring.'\n3.0\npass\nreturn self.time",
}
REFUSED = {
    "print": ("print(self.time)\nreturn 1.0", "unknown_name", "leave it out"),
    "other import": ("import scipy.spatial.transform\nreturn 1.0", "not_allowed", "cannot be imported"),
    "break in some states": (
        "s = 0.0\nfor x in [0.2, 0.4]:\n    if s > self.time:\n        break\n    s += x\nreturn s",
        "not_fixed",
        "around the rest of the loop",
    ),
    "long list": ("s = 0.0\nfor x in np.ones(65):\n    s += x\nreturn s", "steps", "at most 64 turns"),
    "variable of one branch": ("if self.time > 0.5:\n    x = 1.0\nreturn x", "unset", "before the `if`"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_statement_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_a_statement_that_cannot_be_run_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found


def test_the_names_of_a_function_are_those_that_it_sets_itself():
    body = ast.parse("""
import math as m
a, (b, *c) = 1, (2, 3)
for i in range(3):
    d[0] = i
def f(x):
    inner = 1
g = [h for h in a]
""").body
    assert own_names(body) == {"m", "a", "b", "c", "i", "f", "g"}
