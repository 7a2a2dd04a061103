import pytest

from coral.campaign.sweep import in_order, parse_sweeps, setting_text
from coral.errors import InputError


def test_one_key_at_a_time_after_the_nominal_setting():
    assert parse_sweeps(["a.b=1,x", " c = true ", "a.b=1"]) == ({}, {"a.b": 1}, {"a.b": "x"}, {"c": True})
    assert parse_sweeps([]) == ({},)


@pytest.mark.parametrize("text", ["", "a", "=1", "a=", "a=1,,2"])
def test_what_is_no_sweep_is_refused(text):
    with pytest.raises(InputError, match="--sweep"):
        parse_sweeps([text])


def test_infinities_are_no_numbers():
    assert parse_sweeps(["a=NaN"])[1] == {"a": "NaN"}


def test_settings_in_words():
    assert setting_text("{}") == setting_text({}) == "nominal"
    assert setting_text('{"current": 0.2}') == "current=0.2"


def test_settings_are_put_in_order_whenever_they_were_asked_for():
    asked = ['{"b": 2}', '{"b": 10}', '{"a": "x"}', "{}", '{"b": 2}', '{"a": 1}', '{"b": 3.5}']
    assert in_order(asked) == ["{}", '{"b": 2}', '{"b": 3.5}', '{"b": 10}', '{"a": 1}', '{"a": "x"}']
