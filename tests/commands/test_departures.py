"""The list of departures: generated from the code, and whole."""

from pathlib import Path

import pytest

import coral
from coral.cli import main


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
