"""Numbers and truth values of a batch follow the rules of Python and NumPy for one state."""

import numpy as np
import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.scalars import number, scalar, where

YES_NO = np.array([[True, False]])


def test_truth_values_count_as_zero_and_one(meter):
    assert number(meter, True) == 1
    assert number(meter, YES_NO).tolist() == [[1.0, 0.0]]


def test_a_choice_between_truth_values_stays_a_truth_value(meter):
    assert where(meter, YES_NO, True, False).dtype == np.bool_
    assert where(meter, YES_NO, 1, False).dtype == np.int64
    assert where(meter, YES_NO, 1, 0.5).dtype == np.float64


def test_whole_numbers_end_where_arrays_stop_holding_them_exactly(meter):
    assert scalar(meter, "-", 2**53, 1) == 2**53 - 1
    with pytest.raises(CostError) as caught:
        scalar(meter, "+", 2**53, 1)
    assert caught.value.code == "too_large_number"


@pytest.mark.parametrize("symbol", ["/", "//", "%"])
def test_a_division_of_constants_by_zero_is_refused_but_not_one_by_the_state(symbol, meter):
    with pytest.raises(CostError) as caught:
        scalar(meter, symbol, 1.0, 0)
    assert caught.value.code == "division_by_zero"
    with np.errstate(all="ignore"):
        assert scalar(meter, symbol, 1.0, np.array([[2.0, 0.0]])).shape == (1, 2)


def test_a_sum_of_truth_values_of_the_state_is_refused(refusal):
    assert "write float" in refusal("return (self.time > 0.5) + (self.time > 0.2)").text


def test_whole_numbers_of_the_state_stay_whole(meter):
    counts = number(meter, YES_NO)
    assert scalar(meter, "+", counts, 2).dtype == np.int64
    assert scalar(meter, "/", counts, 2).dtype == np.float64
    with pytest.raises(CostError) as caught:
        scalar(meter, "*", scalar(meter, "+", counts, 2**40), 2**40)
    assert caught.value.code == "too_large_number"


def test_a_whole_divisor_that_is_zero_counts_only_where_its_line_does(meter):
    counts = number(meter, YES_NO)
    with pytest.raises(CostError, match="in some state"):
        scalar(meter, "/", 1.0, counts)
    meter.mask = YES_NO
    with np.errstate(all="ignore"):
        assert scalar(meter, "/", 1.0, counts)[0, 0] == 1.0


ZERO = "z, v = 0.0 * self.time, 0.0 * self.ee_pos\nreturn np.tanh({})"
PLAIN = [
    *("float(z)", "(int(z) * 0.5)", "math.sqrt(z)", "abs(float(z))", "max(z - 1.0, 0.0)", "-float(z)"),
    *("(z + 1.0 if self.time < -9.0 else 0.0)", "math.fabs(z)"),
]
"""Numbers that Python holds as its own: it raises where they are 0, where NumPy's give inf."""


@pytest.mark.parametrize("number", PLAIN)
@pytest.mark.parametrize("text", ["1.0 / {}", "2 % {}", "{} ** -1.5", "1 // (-{})"])
def test_what_python_refuses_to_divide_by_is_refused(number, text, refusal):
    assert refusal(ZERO.format(text.format(number))).code in ("division_by_zero", "not_finite")


@pytest.mark.parametrize("number", ["z", "np.sqrt(z)", "float(z) * z", "np.where(z > 0.0, 1.0, 0.0)"])
def test_what_numpy_divides_by_zero_is_infinite(number, agrees):
    with np.errstate(all="ignore"):
        agrees(ZERO.format(f"1.0 / ({number})"))


def test_a_negative_number_of_python_has_no_root(refusal):
    assert refusal("return (float(self.time) - 9.0) ** 0.5").code == "not_finite"
