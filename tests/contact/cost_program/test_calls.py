"""Attributes and calls reach only what a table of this package names; functions of the program bind as in Python."""

import numpy as np
import pytest

from coral.contact.cost.context import Context, Quantity
from coral.contact.cost_program import CostError
from coral.contact.cost_program.calls import read_quantity
from coral.contact.cost_program.limits import Meter

SAME = {
    "defaults and keywords": (
        "def f(x, y=2.0, z=3.0):\n    return x + 10.0 * y + 100.0 * z\n"
        "return f(self.time) + f(1.0, z=0.5) + f(y=4.0, x=self.time)"
    ),
    "helper that returns early": (
        "def f(x):\n    if x > 0.5:\n        return 1.0\n    for i in range(3):\n"
        "        if x > 0.1 * i + 0.2:\n            return 2.0 + i\n    return x\nreturn f(self.time)"
    ),
    "method kept in a variable": "f = self.ee_pos.dot\nreturn f(self.box_pos)",
    "methods of a dict": (
        "d = {'a': self.time, 'c': 2.0}\nreturn sum(d.values()) + len(list(d.keys())) + sum(v for _, v in d.items())"
    ),
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
    "append inside an expression": ("L = []\nreturn L.append(1.0)", "unknown_attribute", "xs = xs + [x]"),
    "argument of a method of a dict": ("d = {'a': 1.0}\nreturn sum(d.values(2))", "wrong_call", "takes no arguments"),
    "index by argmin": ("return np.argmin(self.ee_pos)", "unknown_attribute", "no 'argmin'"),
    "misspelt method": ("return self.ee_pos.summ()", "unknown_attribute", "did you mean 'sum'?"),
    "module of the paper": ("return p.getLinkState(self.panda)[0][0]", "unknown_name", "write self.NAME_pos"),
    "getattr": ("return getattr(self, 'time', 1.0)", "unknown_name", "write self.NAME"),
    "values that are not set everywhere": (
        "d = {'a': 1.0}\nif self.time > 0.5:\n    d['b'] = 2.0\nreturn max(d.values())",
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


@pytest.fixture
def batch(states):
    return Meter(states(np.random.default_rng(0)))


def test_a_quantity_is_read_component_by_component(schema, batch):
    found = read_quantity(batch, schema, "box_pos")
    assert np.array_equal(np.moveaxis(found, 0, -1), batch.context["box_pos"])
    assert read_quantity(batch, schema, "box_hand_contact").dtype == np.bool_


def test_a_name_that_the_state_does_not_have_is_refused_with_a_like_one(schema, batch):
    with pytest.raises(CostError, match=r"did you mean 'box_pos'\?") as caught:
        read_quantity(batch, schema, "bx_pos")
    assert caught.value.code == "unknown_state"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "the batch lacks x"),
        ({"x": np.zeros((4, 5))}, r"x has shape \(4, 5\)"),
        ({"x": np.zeros((4, 5, 2))}, r"x has shape \(4, 5, 2\)"),
        ({"x": np.zeros((3, 5, 3))}, r"in a batch of \(4, 5\)"),
    ],
)
def test_a_batch_that_breaks_its_schema_is_refused(values, words):
    meter = Meter(Context(values, (4, 5)))
    with pytest.raises(CostError, match=words) as caught:
        read_quantity(meter, {"x": Quantity(3, "m", "")}, "x")
    assert caught.value.code == "missing_state"
