"""Built-in functions check their arguments, and follow Python and NumPy; generated calls find no difference."""

import warnings

import numpy as np
import pytest
from cost_oracles import fuzz_programs

from coral.contact.cost_program import CostError
from coral.contact.cost_program.library import BUILTINS, INSTEAD, MATH, NUMPY, PYTHON, Offer, builtin

SAME = {
    "enumerate from a number": "return sum(i * x for i, x in enumerate(self.ee_pos, 2))",
    "range with a step": "return sum(i * self.time for i in range(5, -1, -2)) + len(range(4))",
    "zip backwards": "return sum(a * b for a, b in zip(self.ee_pos[::-1], [1.0, 2.0]))",
    "extremes of a list": "return max([self.time, 0.5]) + min(self.ee_pos) + max(1, 2)",
    "any and all": "return 1.0 * any(x > 0.2 for x in self.ee_pos) + 2.0 * all([self.time > 0.1, True])",
    "tuple and list": "return len(list(range(3)) + list((1.0,))) + tuple(self.ee_pos)[1] + len(list())",
    "truth": "return 1.0 if bool(self.time) else 0.0",
    "math": "return math.radians(90) + math.atan2(self.time, 2.0) + math.fabs(-self.time)",
}
REFUSED = {
    "unknown keyword": ("return max([1, 2], key=abs)", "wrong_call", "unexpected keyword argument 'key'"),
    "argument given twice": ("return np.clip(self.time, 0.0, 1.0, a_min=1.0)", "wrong_call", "multiple values"),
    "too many arguments": ("return norm(self.ee_pos, 2)", "wrong_call", "too many"),
    "missing argument": (
        "return dist(self.ee_pos)",
        "wrong_call",
        "dist takes (p, q): missing",
    ),
    "name of an argument without one": ("return float(value=self.time)", "wrong_call", "positional only"),
    "array of whole numbers": ("return np.array([1, 2], dtype=int)[0]", "unknown_name", "dtype=float, or nothing"),
    "range without a step": ("return sum(range(0, 3, 0))", "wrong_call", "not 0"),
    "range over the state": ("return sum(range(self.current_step))", "not_fixed", "whole numbers"),
    "long range": ("return sum(range(65))", "steps", "at most 64"),
    "whole numbers": ("return round(self.time)", "unknown_name", "no slope to follow"),
    "list of None": ("return len(list(None))", "wrong_type", "None cannot be looped over"),
    "sum of None": ("return sum(None)", "wrong_type", "None cannot be looped over"),
    "largest of nothing": ("return max([])", "wrong_call", "several numbers"),
    "vector in math": ("return math.sqrt(self.ee_pos)", "wrong_type", "takes a number, not a vector of 3"),
    "another sign": ("return np.mod(self.ee_pos[0], 0.3)", "unknown_attribute", "write a % b"),
    "closeness": ("return np.isclose(self.time, 0.5, 1e-3)", "unknown_attribute", "write abs(a - b) < 1e-6"),
    "product of matrices": ("return np.matmul(1.0, 2.0)", "unknown_attribute", "write np.dot(a, b)"),
    "sorting": ("return sorted(self.ee_pos)[0]", "unknown_name", "write max and min"),
    "product of truth values": ("return 1.0 * ((self.ee_pos > 0) @ (self.box_pos > 0))", "wrong_type", "write float"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_builtin_gives_what_python_gives(case, agrees):
    agrees(SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_arguments_that_a_builtin_does_not_take_are_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(body)
    assert (found.code, words in found.text) == (code, True), found


def test_what_is_offered_has_no_hint_to_something_else():
    offered = {*PYTHON, *("np." + name for name in NUMPY), *("math." + name for name in MATH)}
    assert not offered & set(INSTEAD)


def test_a_builtin_binds_arguments_by_place_and_by_name(meter):
    weigh = builtin("weigh", Offer(lambda meter, x, by=2.0: x * by, "n n"))
    assert weigh.call(meter, [3.0], {}) == 6.0
    assert weigh.call(meter, [3.0], {"by": 5.0}) == 15.0
    with pytest.raises(CostError, match=r"weigh takes \(x, by\): missing a required argument: \'x\'"):
        weigh.call(meter, [], {"by": 5.0})
    with pytest.raises(CostError, match="weigh takes a number, not a list of 2"):
        weigh.call(meter, [[1.0, 2.0]], {})


def test_the_largest_entry_of_a_vector_is_found_state_by_state(meter):
    found = BUILTINS["max"].call(meter, [np.array([[[1.0, 3.0]], [[2.0, 2.0]]])], {})
    assert found.tolist() == [[2.0, 3.0]]


@pytest.mark.parametrize(("check", "count"), [("check_calls", 700), ("check_programs", 100)])
def test_generated_cases_agree_with_numpy_or_are_refused(check, count):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tally = getattr(fuzz_programs, check)(count, 7)
    assert tally.findings == []
    assert tally.counts["same"] > count / 2
    assert tally.refused() < 0.25
