"""Factors on the terms of a cost."""

import numpy as np

from coral.contact.control.term_weights import TermWeights
from coral.contact.cost.stages import Stage

TERMS = {"reach": np.array([[2.0, 4.0]]), "open": np.array([[1.0, 1.0]])}


def test_without_factors_the_terms_are_untouched():
    assert TermWeights().weigh("grasp", TERMS) is TERMS


def test_a_factor_acts_on_its_term_in_its_stage_only():
    weights = TermWeights()
    weights.set("grasp", "reach", 0.5)
    weighed = weights.weigh("grasp", TERMS)
    np.testing.assert_array_equal(weighed["reach"], [[1.0, 2.0]])
    assert weighed["open"] is TERMS["open"]
    assert weights.weigh("lift", TERMS) is TERMS


def test_a_stage_is_weighed_with_the_factors_of_now():
    weights, stage = TermWeights(), Stage("grasp", lambda state: TERMS)
    assert weights.weighed(stage) is stage
    weights.set("grasp", "open", 3.0)
    np.testing.assert_array_equal(weights.weighed(stage).cost(None)["open"], [[3.0, 3.0]])


def test_news_tells_the_last_value_of_a_slider_that_was_dragged_once():
    weights = TermWeights()
    for factor in (1.1, 1.5, 2.0):
        weights.set("grasp", "reach", factor)
    weights.set("lift", "open", 0.0)
    assert weights.news() == [("grasp", "reach", 2.0), ("lift", "open", 0.0)]
    assert weights.news() == []
