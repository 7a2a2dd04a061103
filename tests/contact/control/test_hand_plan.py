"""A plan of the hand, and the paths of rollouts that a viewer gets."""

import numpy as np

from coral.contact.control.hand_plan import DRAWN, HandPlan, keep_paths
from coral.contact.cost.context import Context


def test_a_plan_of_targets_alone_is_valid_and_costs_nothing():
    plan = HandPlan(())
    assert (plan.valid, plan.cost, plan.effective_samples) == (True, 0.0, 1.0)
    assert HandPlan((), terms={"reach": 2.0, "lift": -0.5}).cost == 1.5


def test_paths_are_copies_of_valid_rollouts_and_the_best_is_the_heaviest():
    hand = np.arange(100 * 5 * 3, dtype=float).reshape(100, 5, 3)
    box = hand + 0.5
    context = Context({"ee_pos": hand, "box_pos": box}, (100, 5))
    sane = np.arange(100) != 0
    weights = np.zeros(100)
    weights[7] = 1.0
    kept = keep_paths(context, sane, weights, ("box",))
    np.testing.assert_array_equal(kept.best, hand[7])
    np.testing.assert_array_equal(kept.objects["box"], box[7])
    assert DRAWN <= len(kept.some) <= 2 * DRAWN
    assert (kept.some[:, 0, 0] > 0).all()  # the first rollout diverged
    hand[:] = 0.0
    assert kept.best.any()
