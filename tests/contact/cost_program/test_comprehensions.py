"""Comprehensions have the values and the scope that they have in Python, in every state of the batch."""

import pytest

SAME = {
    "a scope of its own": "x = 5.0\nys = [x for x in self.ee_pos]\nreturn x + ys[2]",
    "nested": "return sum(a * b for a in self.ee_pos for b in [1.0, self.time])",
    "filter by constants": "return sum(x * self.time for i, x in enumerate([1.0, 2.0, 4.0]) if i != 1)",
    "source in the enclosing scope": "x = [1.0, 2.0]\nreturn sum([x * self.time for x in x])",
    "pairs": "return sum(k * v for k, v in enumerate(self.ee_pos))",
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_comprehension_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


def test_a_filter_by_the_state_and_a_dict_are_refused_with_another_way(refusal):
    found = refusal("return sum(x for x in self.ee_pos if x > 0.0)")
    assert (found.code, "`x if condition else 0.0`" in found.text) == ("not_fixed", True)
    assert "one by one" in refusal("d = {k: 1.0 for k in ['a', 'b']}\nreturn d['a']").text


def test_its_variable_is_unknown_behind_it(refusal):
    assert "x" in str(refusal("ys = [x for x in self.ee_pos]\nreturn x"))
