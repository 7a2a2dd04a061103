import pytest

from coral.advisor.setting import read_probability
from coral.errors import InputError


@pytest.mark.parametrize(("text", "rate"), [("0", 0.0), ("0.25", 0.25), ("1", 1.0)])
def test_a_probability_is_read(text, rate):
    assert read_probability(text, "P", "--advisor", "P from 0 to 1") == rate


@pytest.mark.parametrize("text", ["-0.1", "1.1", "nan", "inf", "often", ""])
def test_anything_else_is_refused_by_its_name(text):
    with pytest.raises(InputError, match=r"P: found '.*', expected P from 0 to 1"):
        read_probability(text, "P", "--advisor", "P from 0 to 1")
