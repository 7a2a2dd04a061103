import json
import re
from pathlib import Path

import pytest

import coral
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
    assert "  not read, and refused, by: coral reef sail" in told("reef", "simulator.stills").splitlines()


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
    assert set(row) == {"key", "default", "unit", "accepted", "text", "refused_by", "flag"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["reaf"], "found 'reaf', expected one of reef, contact, .*'reef'"),
        (["reef", "stuck_time"], "did you mean 'pilot.trigger.stuck_time_s'"),
    ],
)
def test_a_mistake_is_one_line(capsys, words, said):
    assert main(["config", *words]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert re.search(said, err)


@pytest.fixture
def departures(capsys):
    """Returns what `coral config OF [KEY] --departures` prints."""

    def run(*words):
        assert main(["config", *words, "--departures"]) == 0
        return capsys.readouterr().out

    return run


def test_departures_from_the_paper_are_listed_from_the_code(departures):
    listed = departures("reef")
    keys = [line.split(" = ")[0] for line in listed.splitlines() if " = " in line and not line.startswith(" ")]
    assert {"planner.algorithm", "pilot.trigger.cooldown_s", "belief.inspect.enabled", "planner.route.ahead"} <= set(
        keys
    )
    rows = [line for line in listed.splitlines() if not line.startswith(" ")]
    assert " ".join(listed.split()).count("Departs from the paper:") == len(rows) > len(keys)
    assert max(map(len, listed.splitlines())) <= 120
    assert departures("reef", "pilot.trigger").startswith("pilot.trigger.cooldown_s = 5 s: T_cooldown. Departs")


@pytest.mark.parametrize(
    ("of", "words"),
    [
        (
            "contact",
            ["controller.mppi: ", "48 fine samples", "controller.press_weight = 1: ", "one J for the whole task"],
        ),
        ("contact", ["contact/memory/memory.py: ", "meaning of task and scene", "T2, `pick-box`", "rules name it"]),
        ("reef", ["five points", "a refusal names", "`explore_rest`", "when the answer is needed", "dots with `?`"]),
        (
            "reef",
            ["a tree with branches", "localization.drift_xy = 0: ", "`planner.finished`", "pilot.fallback = rules: "],
        ),
    ],
)
def test_departures_of_groups_and_of_code_without_a_key_are_in_the_same_list(departures, of, words):
    listed = " ".join(departures(of).split())
    assert [word for word in words if word not in listed] == []


def test_every_sentence_about_a_departure_is_listed(departures):
    for of in ("reef", "contact"):
        files = (Path(coral.__file__).parent / of).rglob("*.py")
        said = sum(" ".join(file.read_text().split()).count("Departs from the paper:") for file in files)
        assert " ".join(departures(of).split()).count("Departs from the paper:") == said


def test_departures_of_one_group_are_its_keys_and_groups_alone(departures):
    assert departures("contact", "controller.mppi").startswith("controller.mppi: The sampler")
    assert "memory.py" not in departures("contact", "controller")
