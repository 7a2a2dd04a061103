"""Comprehensions have the values and the scope that they have in Python, in every state of the batch."""

import pytest

SAME = {
    "a scope of its own": "x = 5.0\nys = [x for x in self.ee_pos]\nreturn x + ys[2]",
    "nested": "return sum(a * b for a in self.ee_pos for b in [1.0, self.time] if a > 0.0)",
    "dict from pairs": "d = {k: v for k, v in zip(['a', 'b'], self.ee_pos)}\nreturn {**d, 'a': 2.0}['a'] + d['b']",
    "filter by the state": "return sum(x for x in [1.0, 2.0, 4.0] if x * self.time > 0.5)",
    "guarded by its filter": "return sum(1.0 / x for x in self.ee_pos if x > 0.1)",
    "source in the enclosing scope": "x = [1.0, 2.0]\nreturn sum([x * self.time for x in x])",
    "pairs": "return sum(k * v for k, v in enumerate(self.ee_pos))",
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_comprehension_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


def test_a_dict_is_not_made_with_keys_that_depend_on_the_state(refusal):
    found = refusal("d = {x: 1.0 for x in self.ee_pos}\nreturn 1.0")
    assert found.code == "wrong_type"
    assert "constant texts or whole numbers" in str(found)


def test_its_variable_is_unknown_behind_it(refusal):
    assert "x" in str(refusal("ys = [x for x in self.ee_pos]\nreturn x"))
