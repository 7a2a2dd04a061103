import json

import pytest

from coral.campaign.columns import (
    PAIRS,
    Group,
    column_measure,
    count,
    marked,
    tabulate,
)


def row(world="l1", seed=0, **more):
    return {"world": world, "seed": seed, "status": "done", "advisor": "a", "overrides": "{}", **more}


X = column_measure("x", "x", "x")


def test_a_mean_says_over_how_many_missions_it_is():
    def mean(*rows):
        return X.mean().text(Group("", rows))

    assert mean(row(x=1), row(seed=1, x=2)) == "1.5"
    assert mean(row(x=1), row(seed=1, x=None)) == "1.0 (1/2)"
    assert mean(row(x=None)) == "—"
    assert mean() == "not run"


def test_a_mean_has_its_interval_where_there_is_one():
    assert X.interval().text(Group("", [row(x=1), row("l2", x=3)])) == "2.0 [1.0, 3.0]"
    assert X.interval().text(Group("", [row(x=1)])) == "1.0"


@pytest.mark.parametrize(
    ("ours", "text"),
    [
        ({"l1": 11, "l2": 102}, "+1.5 [+1.0, +2.0]"),
        ({"l1": 9, "l2": 102}, "≈ +0.5 [−1.0, +2.0]"),
        ({"l1": 12, "l3": 7}, "+2.0"),
        ({"l3": 1}, "—"),
    ],
)
def test_differences_are_taken_within_pairs_only(ours, text):
    reference = [row("l1", x=10), row("l2", x=100), row("l4", x=0)]
    assert X.difference().text(Group("", [row(world, x=x) for world, x in ours.items()], reference)) == text


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
