"""The parser accepts what costs need of Python, and refuses the rest with the line and the way to write it."""

from __future__ import annotations

import textwrap

import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.limits import MOST_CHARACTERS
from coral.contact.cost_program.parse import parse


def body(code):
    return "def state_cost(self):\n" + textwrap.indent(textwrap.dedent(code).strip("\n"), "    ") + "\n"


def refused(text):
    with pytest.raises(CostError) as caught:
        parse(text)
    return caught.value


HARD_TO_PARSE = {
    "many parentheses": (body("return " + "(" * 3000 + "1" + ")" * 3000), "too_large"),
    "many minus signs": (body("return " + "-" * 9000 + "1"), "too_large"),
    "many nots": (body("return " + "not " * 4000 + "1"), "too_large"),
    "many attributes": (body("return self" + ".a" * 6000), "too_large"),
    "many ternaries": (body("return " + "1 if 1 else " * 1500 + "1"), "too_large"),
    "deep blocks": (
        "def state_cost(self):\n" + "".join(" " * i + "if 1:\n" for i in range(1, 90)) + " " * 90 + "return 1",
        "too_large",
    ),
    "too long": (body("x = 1\n" * 9000 + "return x"), "too_large"),
    "too many nodes": (body("return " + "+".join(["1"] * 4000)), "too_large"),
    "zero byte": (body("return 1.0\0"), "syntax"),
    "lone surrogate": (body("return '\ud800'"), "syntax"),
}


@pytest.mark.parametrize("case", sorted(HARD_TO_PARSE))
def test_a_text_that_would_exhaust_the_parser_is_refused(case):
    text, code = HARD_TO_PARSE[case]
    assert refused(text).code == code


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("with open('x') as f:\n    pass", "with (leave it out)"),
        ("global x", "return the value instead"),
        ("raise ValueError", "return a large cost instead"),
        ("assert self.time", "assert (leave it out)"),
        ("for i in range(3):\n    pass\nelse:\n    x = 1", "no else after a loop"),
        ("x = {i for i in range(3)}", "write a list"),
        ("import os", "np and math are there already"),
        ("from os import path", "write np.NAME"),
        ("x = f'{self.time}'", "write the text itself"),
        ("def f(a, *, b):\n    return 1", "name the arguments"),
        ("x = self.__class__", "two underscores"),
        ("x = b'bytes'", "no bytes constants"),
        ("x = 1j", "no complex constants"),
        ("def f(*args):\n    return 1", "name the arguments"),
        ("f = lambda **kw: 1", "name the arguments"),
        ("@eval\ndef f():\n    return 1", "no decorators"),
        ("x = self.time ^ 2", "`BitXor`"),
    ],
)
def test_a_part_of_python_that_costs_do_not_have_is_refused_at_its_line(code, words):
    found = refused(body("y = 1\n" + code + "\nreturn 1.0"))
    assert found.code == "not_allowed"
    assert words in found.text
    assert found.line == (4 if code.startswith("@") else 3)
    assert found.shown in code.split("\n")


def test_a_number_that_is_not_exact_is_refused():
    assert refused(body(f"return {2**53 + 1}")).code == "too_large_number"
    assert parse(body(f"return {2**53}")).entry.name == "state_cost"


def test_annotations_are_not_part_of_the_language_and_may_be_anything():
    text = "def state_cost(self: 'Env', k: dict[str, int] = 1) -> np.ndarray:\n    x: lambda: 0 = 1\n    return x\n"
    assert parse(text).entry.name == "state_cost"


def test_the_cost_is_the_last_function_of_that_name_or_the_only_one():
    assert parse("def f(x):\n    return x\n\n" + body("return 1.0")).entry.lineno == 4
    assert parse("def my_cost(env):\n    return 1.0\n").entry.name == "my_cost"
    assert refused("def f(x):\n    return x\n\ndef g(x):\n    return x\n").code == "no_function"


@pytest.mark.parametrize("head", ["state_cost()", "state_cost(self, scale)"])
def test_the_cost_takes_one_argument(head):
    assert "one argument" in refused(f"def {head}:\n    return 1.0").text
    assert parse("def state_cost(self, scale=2.0):\n    return scale").entry.name == "state_cost"


def test_prose_is_no_function_and_broken_code_is_no_python():
    assert refused("I would rather not write that.").code == "no_function"
    assert refused("   \n").code == "empty"
    found = refused(body("return (1.0"))
    assert (found.code, found.line) == ("syntax", 2)


def test_limits_are_inclusive():
    text = body("return 1.0")
    text += "#" * (MOST_CHARACTERS - len(text))
    parse(text)
    assert refused(f"{text}#").code == "too_large"


def test_a_long_sum_is_not_deeply_nested():
    text = body("return " + " + ".join(["self.time"] * 100))
    assert parse(text).source == text
    assert "levels of nesting" in refused(body("return " + " * ".join(["self.time"] * 100))).text
