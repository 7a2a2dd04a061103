"""A scalar cost is reported term by term, and the terms add up to it."""

import ast

import numpy as np
import pytest

from coral.contact.cost_program.sums import addends, summed_variables


def entry(body):
    return ast.parse("def state_cost(self):\n    " + body.replace("\n", "\n    ")).body[0]


def test_a_sum_is_split_through_signs_and_conversions():
    node = ast.parse("a - (b + float(c)) - -d + np.float64(e) * 2", mode="eval").body
    assert [ast.unparse(part) for part in addends(node)] == ["a", "b + float(c)", "-d", "np.float64(e) * 2"]
    assert [ast.unparse(part) for part in addends(ast.parse("-float(a + b)", mode="eval").body)] == ["a", "b"]


@pytest.mark.parametrize(
    ("body", "wanted"),
    [
        ("cost = 0.0\ncost += a\nreturn cost", {"cost"}),
        ("reach += a\ncost = 2.0\nreturn cost + reach", {"reach"}),
        ("part += a\ncost = part + b\nreturn float(cost)", {"cost", "part"}),
        ("reward += a\nreturn -reward", {"reward"}),
        ("x *= a\nreturn x + 1.0", set()),
        ("return a + b", set()),
    ],
)
def test_the_variables_that_reach_the_return_as_sums_are_found(body, wanted):
    assert summed_variables(entry(body)) == wanted


SUMS = {
    "assigned and added": (
        "cost = 2.0 * self.time  # time\ncost += self.gripper_opening\nreturn cost",
        ["time", "gripper_opening"],
    ),
    "subtracted": ("cost = 0.0\ncost -= self.time  # bonus\nreturn cost", ["bonus"]),
    "reward returned with its sign": ("reward = 0.0\nreward += self.time  # progress\nreturn -reward", ["progress"]),
    "sum of variables": ("reach = self.time\nlift = 2.0 * reach\nreturn reach - lift", ["reach", "lift"]),
    "sum of a table": ("t = {'a': self.time, 'b': 2.0}\nreturn sum(t.values())", ["a", "b"]),
    "sum of two sums": (
        "x = 0.0\nx += self.time  # one\ny = 0.0\ny += 2.0  # two\nreturn x + y + self.time",
        ["one", "two", "time"],
    ),
    "forgotten by a product": ("cost = 0.0\ncost += self.time  # lost\ncost *= 2.0\nreturn cost", ["cost"]),
    "added in a loop": ("cost = 0.0\nfor x in self.ee_pos:\n    cost += x ** 2  # gap\nreturn cost", ["gap"]),
}


@pytest.mark.parametrize("case", sorted(SUMS))
def test_the_terms_have_names_and_add_up_to_the_cost(case, terms, agrees):
    body, names = SUMS[case]
    assert list(terms(body)) == names
    agrees(body)


def test_each_term_has_its_sign_and_its_states(terms):
    found = terms("""
        cost = 0.0
        if self.box_hand_contact:
            cost -= 3.0  # touch
        cost = cost + self.time
        return cost - 2.0 * self.time  # twice
    """)
    assert set(np.unique(found["touch"])) == {-3.0, 0.0}
    assert (found["time"] > 0.0).all()
    np.testing.assert_allclose(found["time 2"], -2.0 * found["time"])
