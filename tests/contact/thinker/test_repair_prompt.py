"""Repairs show less of the history where the scene itself is long."""

import numpy as np
import pytest
from histories import TOOL, history, sliding

from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.thinker import repair_prompt
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.repair_prompt import fit_prompt, recent, repair_values

VALUES = {"earlier": ["a", "b", "c"], "history": [1, 2, 3], "terms": ["first", "last"], "code": "return 0.0"}
ROWS = ("earlier", "history", "terms")
BOX = (0.1, 0.0, 0.03)
AHEAD = (0.0, 0.0, 0.33)


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


def test_the_paper_s_repair_tells_five_steps_and_no_diagnosis(monkeypatch):
    steps = [{"object_pos": [0.0, 0.0, 0.1 * k], "cost": 1.0 * k, "touches": []} for k in range(9)]
    monkeypatch.setattr(repair_prompt, "recent", lambda of, costs, name, most, notes: steps[-most:])
    plan = PlanAnswer(code="def state_cost(self):\n    return 0.0")
    monitor = ProgressMonitor(OuterCfg(), ("task",))
    bare, ours = (
        repair_values(plan, None, monitor, "box", ["not-moved"], evidence=["It slipped."], bare=told)
        for told in (True, False)
    )
    assert (bare["diagnosis"], bare["evidence"], ours["evidence"]) == ("", [], ["It slipped."])
    assert ours["diagnosis"]
    assert len(bare["history"]) == 5
    assert set(bare["history"][0]) == {"object_pos", "cost"}


def test_rows_carry_the_cost_of_their_own_plan():
    steps = history(5, period_s=0.1, box=BOX)
    rows = recent(steps, [(0.0, 9.0), (0.2, 7.0), (0.4, 5.0)], "box")
    assert [row["cost"] for row in rows] == [9.0, 9.0, 7.0, 7.0, 5.0]


def test_before_the_first_plan_its_cost_is_shown_and_without_one_none():
    steps = history(2, period_s=0.1, box=BOX)
    assert [row["cost"] for row in recent(steps, [(0.1, 4.0)], "box")] == [4.0, 4.0]
    assert [row["cost"] for row in recent(steps, [], "box")] == [None, None]


def test_a_row_tells_what_was_commanded_and_what_came_of_it():
    (row,) = recent(history(1, box=sliding(2.0), told=AHEAD, force=(0.0, 1.234, 0.0)), [], "box")
    assert row["time_s"] == 0.02
    assert row["object_pos"] == [0.002, 0.0, 0.03]
    assert row["object_moved_mm"] == 2.0
    assert row["hand_pos"] == list(TOOL)
    assert row["hand_told_to"] == list(AHEAD)
    assert row["opening_told_m"] == 0.08
    assert row["force_on_hand_n"] == [0.0, 1.23, 0.0]


def test_rows_are_spread_over_the_stretch_from_its_first_to_its_last_step():
    rows = recent(history(100, box=BOX), [], "box", most=3)
    np.testing.assert_allclose([row["time_s"] for row in rows], [0.02, 1.0, 2.0])
    assert len(recent(history(2, box=BOX), [], "box", most=5)) == 2
    assert recent([], [], "box") == []
