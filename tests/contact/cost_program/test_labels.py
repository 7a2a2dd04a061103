"""The terms of a sum get the names that a reader of the program would give them."""

import ast
import textwrap

import pytest

from coral.contact.cost_program.labels import TermNames


def names(body):
    """The name of each addend of `cost += addend`, in order."""
    source = "def state_cost(self):\n" + textwrap.indent(textwrap.dedent(body).strip("\n"), "    ") + "\n"
    found = TermNames(source)
    added = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.AugAssign)]
    return [found.of(node.value, True, "cost") for node in added]


@pytest.mark.parametrize(
    ("body", "wanted"),
    [
        ("cost += 2.0 * d  # reach the box", ["reach the box"]),
        ("cost += W_REACH * reach_gap", ["reach_gap"]),
        ("cost += self.w_lift * lift / 3.0", ["lift"]),
        ("cost += -height ** 2", ["height"]),
        ("# --- Lift it ---\nx = 1.0\ncost += norm(x - y)", ["Lift it"]),
        ("cost += a * b", ["line 2"]),
        ("cost += d\ncost += d", ["d", "d 2"]),
        ("cost += d  # \x1b[2J", ["[2J"]),
    ],
)
def test_a_term_is_named_by_its_comment_its_variable_or_its_line(body, wanted):
    assert names(body) == wanted


def test_a_long_comment_is_cut_between_words():
    assert names("cost += d  # keep the handle of the board level while the hand lifts it") == [
        "keep the handle of the board level"
    ]


def test_the_same_place_keeps_its_name_and_its_line():
    source = "def state_cost(self):\n    return reach + lift\n"
    found = TermNames(source)
    addition = ast.parse(source).body[0].body[0].value
    assert found.of(addition.right, False, "") == found.of(addition.right, False, "") == "lift"
    assert found.line_of == {"lift": 2}


def test_a_comment_of_the_function_before_is_of_no_term():
    source = "# weights\ndef state_cost(self):\n    return norm(self.ee_pos)\n"
    value = ast.parse(source).body[0].body[0].value
    assert TermNames(source).of(value, True, "") == "cost"
