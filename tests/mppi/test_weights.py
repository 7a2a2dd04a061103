import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.mppi.weights import effective_sample_size, softmax_weights, weighted_mean


def test_weights_match_hand_values():
    weights = softmax_weights(np.array([1.0, 1.0 + 0.1 * np.log(3.0)]), temperature=0.1)
    assert weights == pytest.approx([0.75, 0.25])


def test_infeasible_rollouts_do_not_count_and_none_left_gives_zero():
    weights = softmax_weights(np.array([np.inf, 2.0, np.inf]), temperature=0.1)
    assert weights.tolist() == [0.0, 1.0, 0.0]
    assert softmax_weights(np.full(3, np.inf), temperature=0.1).tolist() == [0.0, 0.0, 0.0]


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=30), st.floats(1e-3, 10.0))
def test_weights_sum_to_one_ignore_an_offset_and_prefer_the_cheap(costs, temperature):
    costs = np.array(costs)
    weights = softmax_weights(costs, temperature)
    assert weights.sum() == pytest.approx(1.0)
    assert weights[np.argmin(costs)] == weights.max()
    assert 1.0 <= effective_sample_size(weights) * (1 + 1e-12) <= len(costs) * (1 + 1e-9)


def test_effective_sample_size_of_extremes():
    assert effective_sample_size(np.full(8, 1 / 8)) == pytest.approx(8.0)
    assert effective_sample_size(np.array([0.0, 1.0])) == 1.0
    assert effective_sample_size(np.zeros(3)) == 0.0


def test_mean_is_taken_over_rollouts():
    sequences = np.array([[[0.0, 2.0], [4.0, 0.0]], [[2.0, 2.0], [0.0, 0.0]]])
    assert weighted_mean(np.array([0.25, 0.75]), sequences).tolist() == [[1.5, 2.0], [1.0, 0.0]]
