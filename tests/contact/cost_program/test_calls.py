"""Attributes and calls reach only what a table of this package names; functions of the program bind as in Python."""

import pytest

SAME = {
    "defaults and keywords": (
        "def f(x, y=2.0, *, z=3.0):\n    return x + 10.0 * y + 100.0 * z\n"
        "return f(self.time) + f(1.0, z=0.5) + f(y=4.0, x=self.time)"
    ),
    "helper that returns early": (
        "def f(x):\n    if x > 0.5:\n        return 1.0\n    for i in range(3):\n"
        "        if x > 0.1 * i + 0.2:\n            return 2.0 + i\n    return x\nreturn f(self.time)"
    ),
    "method kept in a variable": "f = self.ee_pos.dot\nreturn f(self.box_pos)",
    "methods of a dict": (
        "d = {'a': self.time}\ne = d.copy()\ne['b'] = 2.0\n"
        "return d.get('b', 5.0) + sum(e.values()) + len(e.keys()) + sum(v for _, v in e.items())"
    ),
    "shape, ndim and size": (
        "m = np.zeros((2, 3))\nreturn m.shape[1] + 10.0 * m.ndim + 100.0 * m.size + self.ee_pos.size"
    ),
    "starred arguments": "gaps = [self.time, self.gripper_opening, 0.3]\nreturn max(*gaps) - min(2.0, *gaps)",
    "shadowed builtin": "def max(a, b):\n    return a - b\nreturn max(self.time, 3.0)",
}
REFUSED = {
    "too many arguments": ("f = lambda x: x\nreturn f(1.0, 2.0)", "wrong_call", "lambda takes (x)"),
    "missing argument": ("def f(x, y):\n    return x\nreturn f(1.0)", "wrong_call", "f takes (x, y)"),
    "argument given twice": ("def f(x):\n    return x\nreturn f(1.0, x=2.0)", "wrong_call", "f takes (x)"),
    "keywords in a dict": ("d = {'x': 1.0}\nf = lambda x: x\nreturn f(**d)", "not_allowed", "write the keywords"),
    "call of a number": ("x = 1.0\nreturn x(2.0)", "wrong_call", "a number cannot be called"),
    "recursion": ("def f(x):\n    return f(x)\nreturn f(1.0)", "calls", "recursion is not available"),
    "helper without a value in some states": (
        "def f(x):\n    if x > 0.5:\n        return x\nreturn f(self.time)",
        "no_return",
        "end it with a return",
    ),
    "append inside an expression": ("L = []\nreturn L.append(1.0)", "not_allowed", "a statement of its own"),
    "index by argmin": ("return np.argmin(self.ee_pos)", "unknown_attribute", "no 'argmin'"),
    "misspelt method": ("return self.ee_pos.summ()", "unknown_attribute", "did you mean 'sum'?"),
    "misspelt function of p": ("return p.getLinkStat(self.panda)", "unknown_attribute", "did you mean 'getLinkState'?"),
    "getattr by a variable": ("n = 'time'\nreturn getattr(self, n)", "not_allowed", "a literal text"),
    "getattr of a module": ("return getattr(np, 'exp')(1.0)", "not_allowed", "applies to self only"),
    "getattr without a default": ("return getattr(self, 'tme')", "unknown_state", "did you mean 'time'?"),
    "list that is not set everywhere": (
        "xs = [x for x in self.ee_pos if x > 0.0]\nreturn max(xs)",
        "unset",
        "give every entry a value",
    ),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_call_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_a_call_that_cannot_be_made_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found


def test_hasattr_and_getattr_answer_from_the_schema(terms):
    found = terms("""
        return {"known": 1.0 * hasattr(self, "box_pos"), "unknown": 1.0 * hasattr(self, "sphere_pos"),
                "default": getattr(self, "edge_x", 7.0), "value": getattr(self, "time", 7.0) - self.time}
    """)
    assert {name: set(term.ravel()) for name, term in found.items()} == {
        "known": {1.0},
        "unknown": {0.0},
        "default": {7.0},
        "value": {0.0},
    }
