"""Stages of a strategy: on when its test holds, back when another one does."""

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost.stages import Progress, Stage, Strategy


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
