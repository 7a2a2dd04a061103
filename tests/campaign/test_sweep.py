import json

import pytest

from coral.campaign.sweep import by_preset, in_order, parse_sweeps, setting_text, with_presets
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


def test_every_setting_is_run_in_every_water_and_clear_water_needs_no_key():
    assert with_presets(["clear", "hard"], [{}, {"current": 0.2}]) == (
        {},
        {"current": 0.2},
        {"preset": "hard"},
        {"preset": "hard", "current": 0.2},
    )


def test_rows_are_grouped_by_water_and_lose_its_key():
    rows = [
        {"id": 0, "overrides": "{}"},
        {"id": 1, "overrides": json.dumps({"preset": "hard", "current": 0.2})},
        {"id": 2, "overrides": json.dumps({"preset": "hard"})},
    ]
    found = by_preset(rows)
    assert {preset: [row["id"] for row in group] for preset, group in found.items()} == {"clear": [0], "hard": [1, 2]}
    assert json.loads(found["hard"][0]["overrides"]) == {"current": 0.2}
    assert found["hard"][1]["setting"] == found["clear"][0]["setting"]
    assert rows[1]["overrides"] == json.dumps({"preset": "hard", "current": 0.2})  # the rows stay as they were
