"""Repairs show less of the history where the scene itself is long."""

import pytest

from coral.contact.plan.cost_plan import PlanAnswer
from coral.contact.thinker import repair_prompt
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.repair_prompt import fit_prompt, repair_values

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
