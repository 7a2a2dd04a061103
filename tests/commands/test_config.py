import json
import re

import pytest

from coral.cli import main


@pytest.fixture
def told(capsys):
    """Returns what `coral config` prints."""

    def run(*words):
        assert main(["config", *words]) == 0
        return capsys.readouterr().out

    return run


def test_all_keys_are_listed_with_value_unit_and_meaning(told):
    lines = told("reef").splitlines()
    assert len(lines) > 200
    assert any(line.split() == ["time_limit_s", "600", "s"] for line in lines)
    assert max(map(len, lines)) <= 120
    assert lines[-1].startswith("Set one by --cfg.KEY VALUE")


def test_a_group_of_keys_is_listed_under_its_text(told):
    lines = told("reef", "pilot.trigger").splitlines()
    assert lines[0].startswith("Thresholds of Eq. 12")
    assert {line.split(".")[0] for line in lines[2:-2]} == {"pilot"}


@pytest.mark.parametrize("key", ["pilot.trigger.stuck_time_s", "cfg.pilot.trigger.stuck-time-s"])
def test_one_key_is_explained(told, key):
    assert told("reef", key).splitlines() == [
        "pilot.trigger.stuck_time_s = 20 s",
        "  T_stuck.",
        "  accepted: a number >= 0",
        "  set by: --cfg.pilot.trigger.stuck-time-s VALUE",
    ]


def test_who_refuses_a_key_is_told(told):
    assert "  not read, and refused, by: coral reef sail" in told("reef", "lane_m").splitlines()


def test_the_values_of_a_file_are_shown_beside_the_default(told, tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text("time_limit_s: 30\n")
    assert told("reef", "time_limit_s", "--config", str(file)).splitlines()[:1] == ["time_limit_s = 30 s *"]
    assert "default: 600" in told("reef", "time_limit_s", "--config", str(file))


def test_the_values_of_a_variant_are_shown(told):
    assert "decider = nearest *" in told("reef", "decider", "--variant", "rule-based")


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("planning.hand.stiffness_n_m", "N/m"),
        ("planning.hand.axis_torque_limit_n_m", "N m"),
        ("planning.hand.inertia_kg_m2", "kg m²"),
        ("planning.hand.damping_ratio", ""),
    ],
)
def test_the_end_of_a_key_names_its_unit(told, key, unit):
    (row,) = json.loads(told("contact", key, "--json"))["keys"]
    assert row["unit"] == unit


def test_json_has_every_part(told):
    (row,) = json.loads(told("model", "max_retries", "--json"))["keys"]
    assert row["key"] == "max_retries"
    assert row["flag"] == "--model.max-retries"
    assert set(row) == {"key", "default", "value", "unit", "accepted", "text", "refused_by", "flag"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["reaf"], "found 'reaf', expected one of reef, contact, .*'reef'"),
        (["reef", "stuck_time"], "did you mean 'pilot.trigger.stuck_time_s'"),
        (["contact", "--variant", "full"], "--variant: found contact"),
    ],
)
def test_a_mistake_is_one_line(capsys, words, said):
    assert main(["config", *words]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert re.search(said, err)
