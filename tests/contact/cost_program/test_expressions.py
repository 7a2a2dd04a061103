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
    # comprehensions
    "a scope of its own": "x = 5.0\nys = [x for x in self.ee_pos]\nreturn x + ys[2]",
    "nested": "return sum(a * b for a in self.ee_pos for b in [1.0, self.time])",
    "filter by constants": "return sum(x * self.time for i, x in enumerate([1.0, 2.0, 4.0]) if i != 1)",
    "source in the enclosing scope": "x = [1.0, 2.0]\nreturn sum([x * self.time for x in x])",
    "pairs": "return sum(k * v for k, v in enumerate(self.ee_pos))",
    # subscripts
    "slices and steps": "v = self.box_quat\nreturn v[1:][0] + 10.0 * v[::-2][1] + 100.0 * v[-1]",
    "keys": "d = {'a': self.time, 2: 3.0}\nreturn d['a'] + d[2]",
    "slice of a list": "L = [self.time, 2.0, 3.0]\nreturn L[:2][0] + len(L[1:]) + (1.0, 2.0)[-1]",
    "vectors in a list": "L = [self.ee_pos, self.box_pos]\nreturn L[1][2] + 10.0 * L[0][0]",
    # binding
    "tuple": "a, b, c = self.ee_pos\nreturn a + 10.0 * b + 100.0 * c",
    "nested tuple": "(a, b), c = [[1.0, self.time], 3.0]\nreturn a + 10.0 * b + 100.0 * c",
    "swap": "a, b = 1.0, self.time\na, b = b, a\nreturn a + 10.0 * b",
    "loop over pairs": "s = 0.0\nfor k, v in enumerate(self.ee_pos):\n    s = s + k * v\nreturn s",
    "text and whole number as keys": "d = {'a': self.time, 2: 3.0}\nreturn d['a'] + d[2]",
}
REFUSED = {
    "minus a truth value": ("return -self.box_hand_contact", "wrong_type", "write float"),
    "minus a list": ("return np.sum(-[self.time, 1.0])", "wrong_type", "use np.array"),
    "product of truth values": (
        "return 1.0 * ((self.time > 0) * self.box_hand_contact)",
        "wrong_type",
        "write float",
    ),
    "is with a number": ("return 1.0 if self.time is 1.0 else 0.0", "not_allowed", "write =="),
    "in a list": ("return 1.0 if 2 in [1, 2] else 0.0", "not_allowed", "write == and or"),
    "bits of numbers": ("return self.time & 1.0", "not_allowed", "write and"),
    "ellipsis as a value": ("return ...", "not_allowed", "no ellipsis constants"),
    "sides of two kinds": ("x = self.ee_pos if self.time > 0.5 else 1.0\nreturn x", "mixed", "one kind"),
    # subscripts
    "slice of a dict": ("d = {'a': 1.0}\nreturn d[:2]", "not_allowed", "a slice is an index"),
    "two axes": ("return self.ee_pos[0, 1]", "wrong_type", "one axis"),
    "axes of a number": ("return self.time[0]", "wrong_type", "no numbered entries"),
    "unknown key": ("d = {'a': 1.0}\nreturn d['b']", "wrong_size", "it has 'a'"),
    "entry before the first": ("return self.ee_pos[-4]", "wrong_size", "no entry -4"),
    "truth value as an index": ("return self.ee_pos[True]", "not_fixed", "not a truth value"),
    "step of zero": ("return self.ee_pos[::0][0]", "wrong_size", "not 0"),
    "list of indices": ("return self.ee_pos[[0, 1]][0]", "not_fixed", "a constant whole number"),
    "text as an index": ("return self.ee_pos['x']", "not_fixed", "not a text"),
    # binding
    "state as a key": ("d = {self.time: 1.0}\nreturn 1.0", "not_fixed", "constant texts or whole numbers"),
    "too few names": ("a, b = self.ee_pos\nreturn a", "wrong_size", "2 names cannot take 3 values"),
    "starred": ("a, *b = self.ee_pos\nreturn a", "not_allowed", "one by one"),
    # comprehensions
    "filter by the state": (
        "return sum(x for x in self.ee_pos if x > 0.0)",
        "not_fixed",
        "`x if condition else 0.0`",
    ),
    "dict of a comprehension": ("d = {k: 1.0 for k in ['a', 'b']}\nreturn d['a']", "not_allowed", "one by one"),
    "variable behind a comprehension": ("ys = [x for x in self.ee_pos]\nreturn x", "unknown_name", "'x'"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_an_expression_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_an_expression_without_a_value_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found
