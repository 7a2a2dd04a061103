"""Statements run as in Python, with both branches of an `if` on the state joined state by state."""

import ast

import pytest

from coral.contact.cost_program.parse import own_names

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
    # assigning
    "chain of targets": "a = b = self.time\na += 1.0\nreturn a + 10.0 * b",
    "nested targets": "(a, (b, c)), d = (1.0, (self.time, 3.0)), 4.0\nreturn a + 10.0 * b + 100.0 * c + 1000.0 * d",
    "swap": "a, b = 1.0, self.time\na, b = b, a\nreturn a + 10.0 * b",
    "entry of a dict": "d = {'a': 1.0}\nd['b'] = self.time\nd['a'] -= 0.5\nreturn d['a'] + 10.0 * d['b']",
    "entry in a branch": (
        "d = {'a': 1.0}\nif self.time > 0.5:\n    d['a'] = 3.0\n    d['b'] = 2.0\nd['c'] = 5.0\nreturn sum(d.values())"
    ),
    "dict in a loop": "d = {}\nfor i in range(3):\n    d[i] = self.ee_pos[i]\nreturn d[0] + 10.0 * d[2]",
    "dict beside other values": "s, d = 0.0, {'a': 1.0}\nd['a'] = self.time\nreturn d['a'] + s",
    "dicts in a list that are read": (
        "s = 0.0\nfor t in [{'w': 2.0, 'x': self.time}, {'w': 1.0, 'x': 3.0}]:\n    s += t['w'] * t['x']\nreturn s"
    ),
    "array that becomes a new one": "v = self.ee_pos\nu = v\nv = v + 1.0\nreturn u[0] + 10.0 * v[0]",
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
    # assigning
    "attribute of the state": ("self.time = 0.0\nreturn 1.0", "not_allowed", "the state cannot"),
    "entry of the state": ("self.ee_pos[0] = 0.0\nreturn 1.0", "not_allowed", "make a new one"),
    "attribute in place": ("self.ee_pos += 1.0\nreturn 1.0", "not_allowed", "a variable of your own"),
    "sum that does not begin": ("cost += 1.0\nreturn cost", "unset", "begin with cost = 0.0"),
    "entry of an array": ("v = self.ee_pos.copy()\nv[2] += 0.1\nreturn v[2]", "not_allowed", "np.array([...])"),
    "array in place": ("v = self.ee_pos\nu = v\nv += 1.0\nreturn u[0]", "shared", "write v = v + ..."),
    "list in place": ("xs = [1.0]\nxs += [2.0]\nreturn xs[1]", "shared", "write xs = xs + ..."),
    "append": ("xs = [1.0]\nxs.append(2.0)\nreturn xs[1]", "unknown_attribute", "xs = xs + [x]"),
    "update": ("d = {}\nd.update({'a': 1.0})\nreturn 1.0", "unknown_attribute", "are not changed"),
    "dict with two names": ("d = {'a': 1.0}\ne = d\nd['a'] = 2.0\nreturn e['a']", "shared", "under another name"),
    "dict of a list": ("d = {'a': 1.0}\nL = [d]\nd['a'] = 2.0\nreturn L[0]['a']", "shared", "another name"),
    "dict of a tuple": ("t = ({'a': 1.0}, 2.0)\nd, x = t\nd['a'] = 2.0\nreturn t[0]['a']", "shared", "another name"),
    "argument": ("def f(d):\n    d['a'] = 1.0\n    return 1.0\nd = {}\nreturn f(d)", "shared", "another name"),
    "dict of a dict": ("d = {'a': {}}\nd['a']['b'] = 1.0\nreturn 1.0", "not_allowed", "their own name"),
    "dict of the caller": (
        "d = {}\ndef add(x):\n    d['a'] = x\n    return x\nreturn add(1.0) + d['a']",
        "not_allowed",
        "a function's own dicts",
    ),
    "method kept": ("d = {'a': 1.0}\ng = d.values\nd['a'] = 2.0\nreturn sum(g())", "not_allowed", "is called at once"),
    "dict that a loop reads": (
        "d = {'a': 1.0, 'b': 2.0}\nfor k in d:\n    d[k] = 2.0\nreturn d['a']",
        "shared",
        "fill another dict",
    ),
    "too few values": ("a, b = [self.time]\nreturn a", "wrong_size", "2 names cannot take 1 values"),
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
