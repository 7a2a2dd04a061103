"""States and oracles for cost programs."""

import textwrap

import numpy as np
import pytest
from cost_oracles import board, plainly, schema, states  # noqa: F401

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError, CostProgram
from coral.contact.cost_program.limits import Meter


@pytest.fixture
def meter():
    """An evaluation over two states that reads no quantity."""
    return Meter(Context({}, (1, 2)))


def _function(body):
    return "def state_cost(self):\n" + textwrap.indent(textwrap.dedent(body).strip("\n"), "    ") + "\n"


@pytest.fixture
def agrees(schema, states, plainly):  # noqa: F811
    """Checks that the body of a cost gives what Python gives, state by state."""

    def check(body):
        state, source = states(np.random.default_rng(len(body)), 3, 4), _function(body)
        found = sum(CostProgram(source, schema).evaluate(state).values())
        np.testing.assert_allclose(found, plainly(source, state), rtol=1e-9, atol=1e-12)

    return check


@pytest.fixture
def refusal(schema, states):  # noqa: F811
    """The error of the body of a cost; it names a line."""

    def run(body):
        with pytest.raises(CostError) as caught:
            CostProgram(_function(body), schema)(states(np.random.default_rng(0)))
        assert caught.value.line > 0
        return caught.value

    return run


@pytest.fixture
def terms(schema, states):  # noqa: F811
    """The terms of the body of a cost, over four sequences of five states."""

    def run(body):
        return CostProgram(_function(body), schema)(states(np.random.default_rng(0)))

    return run
