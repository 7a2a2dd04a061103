"""Texts are put together from constants only, and stay short."""

import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.texts import LONGEST_TEXT, formatted, joined_text


def test_texts_are_joined_up_to_a_length(meter):
    assert joined_text(meter, ["axis", "_", "0"]) == "axis_0"
    assert len(joined_text(meter, ["x" * LONGEST_TEXT])) == LONGEST_TEXT
    with pytest.raises(CostError) as caught:
        joined_text(meter, ["x" * LONGEST_TEXT, "y"])
    assert caught.value.code == "memory"


@pytest.mark.parametrize(("value", "spec"), [(3, "02d"), (0.125, ".2f"), (0.5, "%"), ("a", ">4"), (2.0, "")])
def test_a_constant_is_formatted_as_in_python(value, spec, meter):
    assert formatted(meter, value, -1, spec) == format(value, spec)


@pytest.mark.parametrize(
    ("value", "conversion", "spec", "code"),
    [
        (1, -1, ">1000000000", "not_allowed"),
        (1, ord("r"), "", "not_allowed"),
        ("a", -1, ".2f", "wrong_type"),
        (None, -1, "", "wrong_type"),
    ],
)
def test_a_format_that_is_not_plain_is_refused(value, conversion, spec, code, meter):
    with pytest.raises(CostError) as caught:
        formatted(meter, value, conversion, spec)
    assert caught.value.code == code


def test_texts_name_terms_as_in_python(agrees):
    agrees("terms = {f'axis_{i:02d}{\"x\"}': abs(self.ee_pos[i]) for i in range(3)}\nreturn terms")
    agrees("d = {'w' + '_' + '1': self.time}\nreturn d['w_1']")


def test_the_state_is_no_text(refusal):
    assert "constant texts" in refusal("return {f'{self.time}': 1.0}").text
