"""Repairs show less of the history where the scene itself is long."""

import pytest

from coral.contact.thinker import repair_prompt
from coral.contact.thinker.repair_prompt import fit_prompt

VALUES = {"earlier": ["a", "b", "c"], "history": [1, 2, 3], "terms": ["first", "last"], "code": "return 0.0"}
ROWS = ("earlier", "history", "terms")


@pytest.fixture
def characters(monkeypatch):
    """Count a row as a thousand characters, and the program as what it has."""

    def render(kind, values):
        return "x" * (1000 * sum(len(values[key]) for key in ROWS) + len(values["code"])), "1"

    monkeypatch.setattr(repair_prompt, "render", render)
    return lambda most: monkeypatch.setattr(repair_prompt, "MOST_CHARACTERS", most)


def rows(fitted):
    return [fitted[key] for key in ROWS]


@pytest.mark.parametrize(
    ("most", "left"),
    [
        (8001, [["a", "b", "c"], [1, 2, 3], ["first", "last"]]),
        (7001, [["a", "c"], [1, 2, 3], ["first", "last"]]),
        (5001, [["c"], [1, 3], ["first", "last"]]),
        (4001, [["c"], [1, 3], ["last"]]),
        (100, [[], [3], ["last"]]),
    ],
)
def test_middle_rows_go_first_and_the_last_ones_stay(characters, most, left):
    characters(most)
    assert rows(fit_prompt("cost-repair", VALUES)) == left


def test_the_authors_program_does_not_count(characters):
    characters(8001)
    assert rows(fit_prompt("cost-repair", {**VALUES, "code": "x" * 5000})) == rows(VALUES)
