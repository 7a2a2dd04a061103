"""Expressions have the values of Python in every state of the batch, and count only where Python would reach them."""

import pytest

SAME = {
    "and gives the deciding value": "return (self.time and 3.0) + 2.0 * (self.box_hand_contact and self.time > 0.5)",
    "or gives the deciding value": "return (0.0 or self.time) + ((self.time - self.time) or 2.0)",
    "chained comparison": "return 1.0 if 0.2 < self.time <= self.gripper_opening < 2.0 else 0.0",
    "guarded division": "return 1.0 / self.ee_pos[0] if self.ee_pos[0] > 0.1 else 0.0",
    "operators of precedence": "return -self.time ** 2 + 2.0 * 3.0 ** -1 - (7 % 4) + 7 // 2",
    "lambda keeps the variable, not its value": "k = 1.0\nf = lambda x: k * x\nk = 3.0\nreturn f(self.time)",
    "default is evaluated once": "k = 1.0\ndef f(x, by=k):\n    return by * x\nk = 3.0\nreturn f(self.time)",
}
REFUSED = {
    "a truth value or a number": ("return self.box_hand_contact and self.time", "mixed", "write float"),
    "minus a truth value": ("return -self.box_hand_contact", "wrong_type", "write float"),
    "minus a list": ("return np.sum(-[self.time, 1.0])", "wrong_type", "use np.array"),
    "product of truth values": (
        "return 1.0 * ((self.time > 0) * self.box_hand_contact)",
        "wrong_type",
        "write float",
    ),
    "whole divisor that may be 0": ("return 1.0 / int(self.time * 0.5)", "division_by_zero", "in some state"),
    "is with a number": ("return 1.0 if self.time is 1.0 else 0.0", "not_allowed", "write =="),
    "in a list": ("return 1.0 if 2 in [1, 2] else 0.0", "not_allowed", "write == and or"),
    "bits of numbers": ("return self.time & 1.0", "not_allowed", "write and"),
    "ellipsis as a value": ("return ...", "not_allowed", "no ellipsis constants"),
    "sides of two kinds": ("x = self.ee_pos if self.time > 0.5 else 1.0\nreturn x", "mixed", "one kind"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_an_expression_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_an_expression_without_a_value_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
