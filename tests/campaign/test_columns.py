import json

import pytest

from coral.campaign.columns import (
    PAIRS,
    Group,
    column_measure,
    count,
    difference_text,
    marked,
    mean_interval_text,
    mean_text,
    number,
    tabulate,
)
from coral.campaign.stats import Estimate


def row(world="l1", seed=0, **more):
    return {"world": world, "seed": seed, "status": "done", "advisor": "a", "overrides": "{}", **more}


def test_a_mean_says_over_how_many_missions_it_is():
    measure = column_measure("x", "x", "x")
    assert mean_text([row(x=1), row(seed=1, x=2)], measure) == "1.5"
    assert mean_text([row(x=1), row(seed=1, x=None)], measure) == "1.0 (1/2)"
    assert mean_text([row(x=None)], measure) == "—"
    assert mean_text([], measure) == "not run"


def test_a_mean_has_its_interval_where_there_is_one():
    measure = column_measure("x", "x", "x")
    assert mean_interval_text([row(x=1), row("l2", x=3)], measure) == "2.0 [1.0, 3.0]"
    assert mean_interval_text([row(x=1)], measure) == "1.0"


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (Estimate(-3.14, -5.0, -1.26, 9), "−3.1 [−5.0, −1.3]"),
        (Estimate(1.0, -0.01, 2.0, 9), "≈ +1.0 [0.0, +2.0]"),
        (Estimate(2.0, float("nan"), float("nan"), 1), "+2.0"),
        (Estimate(0.0, 0.0, 0.0, 0), "—"),
    ],
)
def test_differences_in_words(estimate, text):
    assert difference_text(estimate, 1) == text


def test_zero_has_no_sign():
    assert (number(-0.04, 1), number(0.0, 2, sign=True), number(-0.06, 1)) == ("0.0", "0.00", "−0.1")


COVERAGE = column_measure("coverage", "coverage (%)", "coverage", 100.0)


def missions(*coverages):
    return [{"world": f"w{k}", "seed": 0, "coverage": value} for k, value in enumerate(coverages)]


def test_a_table_has_a_line_for_each_group_and_a_cell_for_each_column():
    full = missions(1.0, 1.0)
    groups = [Group("slow", missions(0.5, 0.5), full, {"coverage": "67"}), Group("same", full, full)]
    columns = (count("missions"), COVERAGE.mean(), COVERAGE.paper(), PAIRS, COVERAGE.difference(), COVERAGE.change())
    table = tabulate("Means", "Of all.", "variant", groups, columns, ("From where.",))
    assert table.header == ("variant", "missions", "coverage (%)", "paper", "pairs", "Δ coverage (%)", "Δ coverage (%)")
    assert table.rows == (
        ("slow", "2", "50.0", "67", "2", "−50.0 [−50.0, −50.0]", "−50"),
        ("same", "2", "100.0", "–", "2", "≈ 0.0 [0.0, 0.0]", "0"),
    )
    assert table.notes == ("From where.",)


def test_lines_in_which_a_fallback_decided_are_marked():
    def by(fallback):
        return {"decided_by": json.dumps({"advisor": 5, "fallback": fallback})}

    assert marked("full", [by(0), by(1)]) == "full §"
    assert marked("full", [by(0)]) == "full"
    assert marked("full", [{"coverage": 1.0}]) == "full"  # of a version that did not count
