"""MPPI over knots: sampling, the update law and the warm start."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.mppi.knots import KnotMppi, KnotMppiCfg, basis, interpolate, shift, spread

CFG = KnotMppiCfg(samples=64, knots=4, fine=0.0)


def planner(cfg=CFG, sigma=(0.1, 0.5), seed=0, groups=None):
    return KnotMppi(cfg, np.array(sigma), np.random.default_rng(seed), groups)


def test_the_plan_itself_is_the_first_sample():
    mppi = planner()
    mppi.knots[:] = 3.0
    assert np.array_equal(mppi.sample()[0], mppi.knots)


def test_noise_grows_along_the_ramp():
    cfg = dataclasses.replace(CFG, samples=20000, ramp=(0.5, 2.0))
    deviation = planner(cfg).sample()[1:].std(axis=0)
    assert deviation == pytest.approx(np.linspace(0.5, 2.0, 4)[:, None] * [0.1, 0.5], rel=0.03)


def test_only_a_share_of_the_samples_is_fine():
    moved = planner(dataclasses.replace(CFG, samples=40, fine=0.5), (0.1,) * 7, groups=(3, 3, 1)).sample() != 0.0
    everything = moved.all(axis=(1, 2))
    assert everything[20:].all()
    assert not everything[:20].all()


def test_each_fine_sample_has_a_width_of_its_own():
    cfg = dataclasses.replace(CFG, samples=4000, knots=50, fine=1.0, finest=0.1, ramp=(1.0, 1.0))
    widths = planner(cfg, (0.5, 0.5)).sample()[1:].std(axis=(1, 2)) / 0.5
    assert widths.min() == pytest.approx(0.1, rel=0.3)
    assert widths.max() == pytest.approx(1.0, rel=0.3)
    assert np.median(widths) == pytest.approx(np.sqrt(0.1), rel=0.1)  # evenly in the logarithm


def test_groups_of_axes_are_perturbed_apart():
    cfg = dataclasses.replace(CFG, samples=4000, fine=1.0, perturbed=0.5)
    moved = (planner(cfg, (0.1, 0.1, 0.1), groups=(2, 1)).sample()[1:] != 0.0).all(axis=1)
    assert (moved[:, 0] == moved[:, 1]).all()
    assert moved.any(axis=1).all()  # none of them perturbs nothing
    assert moved[:, 0].mean() == pytest.approx(0.5 + 0.125, abs=0.03)
    assert moved[:, 2].mean() == pytest.approx(0.5 + 0.125, abs=0.03)


def test_what_has_nearly_been_reached_is_ended():
    """1.6 cm are left with noise of 4 cm on seven axes: with equal noise, 40 samples are all worse than the plan."""

    def left(**changes):
        mppi = KnotMppi(
            KnotMppiCfg(samples=40, **changes), np.full(7, 0.04), np.random.default_rng(0), groups=(3, 3, 1)
        )
        goal = np.array([0, 0, -0.016, 0, 0, 0, 0])

        def cost(knots):
            off = knots - goal
            parts = np.linalg.norm(off[..., :3], axis=-1), np.linalg.norm(off[..., 3:6], axis=-1), np.abs(off[..., 6])
            return np.sum(parts, axis=0).mean(axis=-1)

        for _ in range(30):
            mppi.improve(cost)
        return float(cost(mppi.knots))

    assert left(fine=0.0) == pytest.approx(0.016)
    assert left() < 0.011


def test_weights_by_hand():
    cfg = KnotMppiCfg(samples=2, knots=1, temperature=0.5, spread_quantile=1.0, fine=0.0)
    update = planner(cfg, (1.0,)).improve(lambda knots: np.array([0.0, 2.0]))
    # The spread of (0, 2) is 1, so lambda = 0.5 and the weights are as 1 to exp(-4).
    assert update.weights == pytest.approx(np.array([1.0, np.exp(-4)]) / (1 + np.exp(-4)))
    assert update.knots == pytest.approx(np.tensordot(update.weights, update.sampled, axes=1))
    assert update.effective_samples == pytest.approx(1 / np.square(update.weights).sum())


def test_rollouts_that_do_not_count_have_no_weight():
    update = planner().improve(lambda knots: np.where(np.arange(64) < 62, np.nan, [1.0] * 64))
    assert update.ok
    assert update.weights[:62].sum() == 0
    assert update.weights[62:] == pytest.approx([0.5, 0.5])


def test_the_plan_stays_where_nothing_counts():
    mppi = planner()
    mppi.knots[:] = 2.0
    update = mppi.improve(lambda knots: np.full(64, np.inf))
    assert not update.ok
    assert np.array_equal(update.knots, np.full((4, 2), 2.0))
    assert update.effective_samples == 0


def test_finds_the_bottom_of_a_bowl():
    mppi, goal = planner(sigma=(0.3, 0.3)), np.array([1.0, -2.0])
    for _ in range(40):
        mppi.improve(lambda knots: np.square(knots - goal).sum(axis=(1, 2)))
    assert mppi.knots == pytest.approx(np.tile(goal, (4, 1)), abs=0.25)


def test_bounds_hold_for_every_sample_and_for_the_plan():
    mppi = planner(sigma=(5.0, 5.0))
    update = mppi.improve(lambda knots: -knots.sum(axis=(1, 2)), bound=lambda knots: np.clip(knots, -1, 1))
    assert np.abs(update.sampled).max() <= 1
    assert np.abs(update.knots).max() <= 1


def test_proposals_are_weighed_like_samples():
    def propose(sampled):
        sampled[-1] = 9.0
        return sampled

    update = planner(sigma=(0.01, 0.01)).improve(lambda knots: np.abs(knots - 9).sum(axis=(1, 2)), propose)
    assert update.weights[-1] == pytest.approx(1.0)


def test_same_seed_same_plan_bit_for_bit():
    first, second = (planner(seed=5).improve(lambda knots: knots.sum(axis=(1, 2))).knots for _ in range(2))
    assert np.array_equal(first, second)


def test_advance_begins_the_plan_later():
    mppi = planner()
    mppi.knots[:, 0] = [0.0, 1.0, 2.0, 3.0]
    mppi.advance(0.5, 3.0)
    assert mppi.knots[:, 0] == pytest.approx([0.5, 1.5, 2.5, 3.0])


def test_an_invalid_sample_has_no_weight():
    mppi = planner(CFG)
    assert not mppi.improve(lambda knots: np.full(64, np.nan)).ok
    update = mppi.improve(lambda knots: np.where(np.arange(64) == 7, 1.0, np.nan))
    assert update.weights[7] == 1.0


@pytest.mark.parametrize(
    ("costs", "quantile", "expected"),
    [
        ([1.0, 3.0], 1.0, 1.0),
        ([1.0, 3.0, np.inf], 1.0, 1.0),
        ([4.0, 4.0], 1.0, 1.0),
        ([2.0], 1.0, 1.0),
        ([], 1.0, 1.0),
        ([0.0, 1.0, 2.0, 1e9], 0.75, np.sqrt(2 / 3)),
    ],
)
def test_spread(costs, quantile, expected):
    assert spread(np.array(costs), quantile) == pytest.approx(expected)


def test_between_three_knots():
    values = interpolate(np.array([[0.0], [1.0], [4.0]]), np.linspace(0, 2, 5), 2.0)
    assert values[:, 0] == pytest.approx([0.0, 0.5, 1.0, 2.5, 4.0])


def test_held_outside():
    knots = np.array([[2.0, -1.0], [5.0, 3.0]])
    assert interpolate(knots, np.array([-3.0, 9.0]), 1.0) == pytest.approx(knots)


@given(knots=st.integers(1, 8), steps=st.integers(1, 30), span=st.floats(0.1, 5))
def test_constants_stay_constant(knots, steps, span):
    matrix = basis(np.linspace(0, span, steps), knots, span)
    assert matrix.shape == (steps, knots)
    assert matrix.sum(axis=1) == pytest.approx(1.0)


@given(knots=st.integers(2, 12), span=st.floats(0.1, 5))
def test_passes_through_its_knots(knots, span):
    assert basis(np.linspace(0, span, knots), knots, span) == pytest.approx(np.eye(knots), abs=1e-6)


def test_batches_as_one_by_one():
    knots = np.random.default_rng(0).normal(size=(4, 5, 3))
    times = np.linspace(0, 1, 9)
    assert interpolate(knots, times, 1.0)[2] == pytest.approx(interpolate(knots[2], times, 1.0))


def test_shift_by_nothing_and_by_a_knot():
    knots = np.array([[0.0], [1.0], [4.0], [9.0]])
    assert shift(knots, 0.0, 3.0) == pytest.approx(knots)
    assert shift(knots, 1.0, 3.0)[:, 0] == pytest.approx([1.0, 4.0, 9.0, 9.0])


def test_shift_by_half_a_knot():
    assert shift(np.array([[0.0], [1.0], [4.0]]), 0.5, 2.0)[:, 0] == pytest.approx([0.5, 2.5, 4.0])


def test_one_knot_is_a_constant():
    assert interpolate(np.array([[7.0]]), np.linspace(0, 1, 4), 1.0) == pytest.approx(np.full((4, 1), 7.0))


def test_the_kept_matrix_cannot_be_spoilt():
    with pytest.raises(ValueError, match="read-only"):
        basis(np.array([0.0, 1.0]), 2, 1.0)[0, 0] = 3.0
