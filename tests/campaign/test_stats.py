import math

import numpy as np
import pytest

from coral.campaign.stats import bootstrap_mean, paired_difference, sign_test, wilson


def test_interval_agrees_with_the_normal_one_for_many_single_missions():
    values = np.random.default_rng(1).normal(5.0, 2.0, 400)
    estimate = bootstrap_mean(values, range(400))
    half = 1.96 * values.std() / 20
    assert estimate.mean == pytest.approx(values.mean())
    assert estimate.low == pytest.approx(values.mean() - half, abs=0.03)
    assert estimate.high == pytest.approx(values.mean() + half, abs=0.03)


def test_two_groups_by_hand():
    """Drawn twice out of {0, 8}: means 0, 4, 8 with 1/4, 1/2, 1/4, so the interval is all of [0, 8]."""
    estimate = bootstrap_mean([0.0, 0.0, 8.0, 8.0], ["a", "a", "b", "b"])
    assert (estimate.mean, estimate.low, estimate.high, estimate.count) == (4.0, 0.0, 8.0, 4)


def test_copies_of_a_mission_tell_nothing_new():
    once = bootstrap_mean([1.0, 5.0, 9.0], ["a", "b", "c"])
    often = bootstrap_mean([1.0, 5.0, 9.0] * 10, ["a", "b", "c"] * 10)
    assert (often.low, often.high) == (once.low, once.high)


def test_groups_count_by_their_size():
    estimate = bootstrap_mean([0.0, 0.0, 0.0, 4.0], ["a", "a", "a", "b"])
    assert estimate.mean == 1.0
    assert (estimate.low, estimate.high) == (0.0, 4.0)


def test_one_world_falls_back_to_its_missions_one_mission_to_no_interval():
    assert bootstrap_mean([1.0, 3.0], ["a", "a"]).high == 3.0
    assert math.isnan(bootstrap_mean([1.0], ["a"]).low)
    assert bootstrap_mean([], []).count == 0


def test_the_same_values_give_the_same_interval():
    values = np.random.default_rng(2).normal(size=20)
    assert bootstrap_mean(values, range(20)) == bootstrap_mean(values, range(20))


def test_differences_are_taken_within_pairs_only():
    world = {key: key[0] for key in (("a", 0), ("a", 1), ("b", 0), ("b", 1))}
    ours = {("a", 0): 11.0, ("a", 1): 102.0, ("b", 0): 1003.0}
    reference = {("a", 0): 10.0, ("a", 1): 100.0, ("b", 0): 1000.0, ("b", 1): 7.0}
    estimate = paired_difference(ours, reference, world)
    assert (estimate.mean, estimate.low, estimate.high, estimate.count) == (2.0, 1.5, 3.0, 3)
    assert estimate.tells
    assert not paired_difference({("a", 0): 9.0, ("b", 0): 1001.0}, reference, world).tells


@pytest.mark.parametrize(
    ("won", "trials", "low", "high"),
    [(0, 10, 0.0, 0.2775), (10, 10, 0.7225, 1.0), (5, 10, 0.2366, 0.7634), (0, 0, 0.0, 1.0)],
)
def test_wilsons_interval(won, trials, low, high):
    assert wilson(won, trials) == (pytest.approx(low, abs=1e-4), pytest.approx(high, abs=1e-4))


def test_the_sign_test_is_the_binomial_one():
    assert sign_test(0, 0) == 1.0
    assert sign_test(8, 0) == sign_test(0, 8) == pytest.approx(2 / 2**8)
    assert sign_test(18, 4) == pytest.approx(0.0043435, abs=1e-7)
    assert sign_test(3, 3) == 1.0
