import itertools

import numpy as np
import pytest

from coral.reef.vehicle.delays import delays_from, order_from


def mean_delay(order, between, worth):
    times = np.concatenate([[0.0], np.cumsum([between[a, b] for a, b in itertools.pairwise(order)])])
    return float(np.dot(times, worth[list(order)]) / worth.sum())


@pytest.fixture
def places():
    rng = np.random.default_rng(3)
    points, worth = rng.uniform(0, 10, (6, 2)), rng.uniform(0.1, 2.0, 6)
    return np.linalg.norm(points[:, None] - points[None], axis=2), worth


def test_delays_agree_with_trying_every_order(places):
    between, worth = places
    for first, delay in enumerate(delays_from(between, worth)):
        orders = ((first, *rest) for rest in itertools.permutations([k for k in range(6) if k != first]))
        assert delay == pytest.approx(min(mean_delay(order, between, worth) for order in orders))


def test_the_order_has_the_delay_that_was_computed_for_it(places):
    between, worth = places
    for first, delay in enumerate(delays_from(between, worth)):
        order = order_from(first, between, worth)
        assert order[0] == first
        assert mean_delay(order, between, worth) == pytest.approx(delay)


def test_what_is_worth_more_comes_first():
    between = np.array([[0.0, 4.0, 4.0], [4.0, 0.0, 8.0], [4.0, 8.0, 0.0]])
    assert order_from(0, between, np.array([1.0, 1.0, 3.0])) == [0, 2, 1]
