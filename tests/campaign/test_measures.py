import pytest

from coral.campaign.measures import difference_text, field, mean_interval_text, mean_text, number, select, time_to_count
from coral.campaign.stats import Estimate


def row(world="l1", seed=0, **more):
    return {"world": world, "seed": seed, "status": "done", "advisor": "a", "overrides": "{}", **more}


@pytest.mark.parametrize(("count", "time"), [(1, 5.0), (3, 40.0), (4, None), (0, None), (None, None)])
def test_coverage_time_is_when_the_other_ones_count_was_reached(count, time):
    reference = {} if count is None else {("l1", 0): count}
    assert time_to_count(reference).of(row(covered_at_s=[5.0, 9.0, 40.0])) == time


def test_coverage_time_of_a_mission_that_covered_nothing():
    assert time_to_count({("l1", 0): 1}).of(row(covered_at_s=None)) is None


def test_selection_keeps_finished_missions_of_the_advisor_and_those_without_one():
    rows = [row(), row(advisor="none"), row(advisor="b"), row(status="failed"), row(overrides='{"x": 1}')]
    assert select(rows, "a", "{}") == rows[:2]


def test_a_mean_says_over_how_many_missions_it_is():
    measure = field("x", "x", "x")
    assert mean_text([row(x=1), row(seed=1, x=2)], measure) == "1.5"
    assert mean_text([row(x=1), row(seed=1, x=None)], measure) == "1.0 (1/2)"
    assert mean_text([row(x=None)], measure) == "—"
    assert mean_text([], measure) == "not run"


def test_a_mean_has_its_interval_where_there_is_one():
    measure = field("x", "x", "x")
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
