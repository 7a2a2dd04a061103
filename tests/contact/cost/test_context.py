"""Batches of states under their names, computed at their first read."""

import numpy as np
import pytest

from coral.contact.cost.context import Context, Derived, Lazy


def test_values_are_computed_once_and_only_when_read():
    made = []

    def maker(name):
        def make():
            made.append(name)
            return np.zeros((2, 3))

        return make

    values = Lazy({name: maker(name) for name in ("a", "b")})
    assert "a" in values
    assert (len(values), list(values), made) == (2, ["a", "b"], [])
    assert values["a"] is values["a"]
    assert made == ["a"]


def test_an_unknown_name_is_an_attribute_error():
    state = Context({"a": np.zeros((1, 1))}, (1, 1))
    with pytest.raises(AttributeError, match="nothing"):
        _ = state.nothing


def test_the_first_state_is_a_batch_of_one():
    values = {"p": np.arange(24.0).reshape(2, 4, 3), "constant": np.ones((1, 1))}
    first = Context(values, (2, 4)).first()
    assert first.shape == (1, 1)
    np.testing.assert_array_equal(first.p, [[[0.0, 1.0, 2.0]]])
    assert first.constant.shape == (1, 1)
    assert first.names() == ["constant", "p"]


def test_a_derived_value_follows_the_state_that_it_is_read_from():
    counted = []

    def double(state):
        counted.append(state)
        return 2.0 * state.a

    values = {"a": np.arange(8.0).reshape(2, 4), "twice": Derived(double)}
    state = Context(values, (2, 4))
    np.testing.assert_array_equal(state.twice, 2.0 * values["a"])
    assert state.twice is state["twice"]
    assert len(counted) == 1
    other = Context({**{name: state.source(name) for name in state.names()}, "a": np.ones((2, 4))}, (2, 4))
    np.testing.assert_array_equal(other.twice, 2.0 * np.ones((2, 4)))
    np.testing.assert_array_equal(state.first().twice, [[0.0]])
