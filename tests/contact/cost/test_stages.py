"""Stages of a strategy: on when its test holds, back when another one does."""

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost.stages import Progress, Stage, Strategy, TermWeights

TERMS = {"reach": np.array([[2.0, 4.0]]), "open": np.array([[1.0, 1.0]])}


def at(x):
    return Context({"x": np.array([[float(x)]])}, (1, 1))


def beyond(limit):
    return lambda now: bool(now.x[0, 0] > limit)


@pytest.fixture
def progress():
    free = lambda now: {}  # noqa: E731
    return Progress(
        Strategy(
            "walk",
            (
                Stage("near", free, until=beyond(1.0)),
                Stage("far", free, until=beyond(2.0), next=(("near", lambda now: bool(now.x[0, 0] < 0.5)),)),
                Stage("there", free),
            ),
        )
    )


def test_a_stage_ends_when_its_test_holds_and_one_at_a_time(progress):
    assert not progress.update(at(0.7))
    assert progress.update(at(5.0))
    assert progress.stage.name == "far"
    assert progress.update(at(5.0))
    assert progress.stage.name == "there"


def test_the_last_stage_has_no_next_one(progress):
    progress.index = 2
    assert not progress.update(at(9.0))
    assert progress.stage.name == "there"


def test_what_was_lost_leads_back_before_what_is_reached_leads_on():
    both = lambda now: True  # noqa: E731
    strategy = Strategy("x", (Stage("a", both), Stage("b", both, until=both, next=(("a", both),)), Stage("c", both)))
    progress = Progress(strategy)
    progress.index = 1
    assert progress.update(at(0))
    assert progress.stage.name == "a"


def test_a_stage_is_found_by_its_name(progress):
    assert progress.strategy.stage("there") == 2
    with pytest.raises(StopIteration):
        progress.strategy.stage("nowhere")


def test_a_strategy_may_begin_with_another_stage_than_the_first(progress):
    strategy = Strategy("later", progress.strategy.stages, begin="far")
    assert Progress(strategy).stage.name == "far"


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
