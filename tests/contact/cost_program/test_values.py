"""The values of a cost program: their words in errors, and their size."""

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError
from coral.contact.cost_program.limits import MOST_ITEMS, Meter
from coral.contact.cost_program.values import (
    Module,
    State,
    bounded,
    kind,
    weight,
)


@pytest.mark.parametrize(
    ("value", "word"),
    [
        (np.array([[1.0]]), "a number"),
        (np.array([[True]]), "a truth value"),
        (False, "a truth value"),
        (3, "a number"),
        (np.ones((2, 1, 1)), "a vector of 2"),
        ((1.0,), "a tuple of 1"),
        ([], "a list of 0"),
        ({}, "a dict"),
        (State(), "self"),
        (Module("np"), "a module"),
        (None, "None"),
        (object(), "such a value"),
    ],
)
def test_an_error_calls_a_value_what_its_author_would(value, word):
    assert kind(value) == word


def test_nested_entries_count_and_shared_ones_count_each_time():
    row = np.ones((2, 1, 1))
    assert weight([row, row], 100) == 7
    assert weight({"a": 1.0, "b": [1.0]}, 100) == 4
    assert weight(3.0, 100) == 1


def test_a_doubling_list_is_weighed_only_up_to_the_limit():
    value = [1.0, 1.0]
    for _ in range(60):
        value = [value, value]
    assert 100 < weight(value, 100) < 300


def test_a_container_above_the_limit_is_refused():
    meter = Meter(Context({}, (1, 1)))
    value = np.ones((MOST_ITEMS - 1, 1, 1))
    assert bounded(meter, value) is value
    with pytest.raises(CostError, match="a vector of 1024 holds more than 1024 entries"):
        bounded(meter, np.ones((MOST_ITEMS, 1, 1)))
