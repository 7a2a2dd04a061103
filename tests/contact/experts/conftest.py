"""Shipped tasks at their beginning, as the costs of the experts read them."""

import numpy as np
import pytest

from coral.contact.cost.context import Context


@pytest.fixture
def state_of(scene):
    """A function that gives the present state of a task, with some quantities changed, as a batch of one."""

    first = {}

    def state(name, **changed):
        if name not in first:
            one = scene(name)
            present = one.world.present(one.now)
            first[name] = {key: np.array(present[key], dtype=float) for key in present.names()}
        values = dict(first[name])
        unknown = set(changed) - set(values)
        assert not unknown, unknown
        values |= {key: np.asarray(value, dtype=float).reshape(values[key].shape) for key, value in changed.items()}
        return Context(values, (1, 1))

    return state


def total(terms):
    """The cost of a single state."""
    return float(sum(np.asarray(term).item() for term in terms.values()))


@pytest.fixture
def cost_of():
    """The cost of a stage in a single state."""
    return lambda stage, state: total(stage.cost(state))
