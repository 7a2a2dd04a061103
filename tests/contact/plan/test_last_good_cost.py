import numpy as np
import pytest
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError, CostProgram
from coral.contact.plan.last_good_cost import LastGoodCost

GOOD = "def state_cost(self):\n    return {'reach': 5.0 * norm(self.ee_pos - self.box_pos)}"
FRAGILE = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos) + 1.0 / max(0.0, self.time)"


@pytest.fixture(scope="module")
def sample():
    return rolled_out(np.random.default_rng(0))[0]


@pytest.fixture(scope="module")
def at_zero(sample):
    """The states at time 0, where the fragile cost divides by zero."""
    return Context({**{n: sample[n] for n in sample.names()}, "time": np.zeros(sample.shape)}, sample.shape)


def program(source, name):
    return CostProgram(source, SCHEMA, name)


def kept(*sources):
    """Costs that were in use one after the other, and what is told of failures."""
    told = []
    cost = LastGoodCost(lambda error: told.append(error.code))
    return cost, [cost.following(program(source, name)) for name, source in sources], told


def test_without_a_cost_there_is_nothing_to_plan_with(sample):
    cost, _, told = kept()
    assert cost.name == "none"
    with pytest.raises(CostError, match="no cost"):
        cost(sample)
    assert told == []


def test_the_plan_goes_on_with_the_last_good_cost_and_does_not_return_to_the_one_that_failed(sample, at_zero):
    cost, (good, fragile), told = kept(("good", GOOD), ("fragile", FRAGILE))
    good(sample)
    assert cost.name == "good"
    fragile(sample)
    assert cost.name == "fragile"
    assert list(fragile(at_zero)) == ["reach"]
    assert (cost.name, told) == ("good", ["division_by_zero"])
    assert list(fragile(sample)) == ["reach"]


def test_the_only_cost_stays_in_use_and_its_error_is_raised(sample, at_zero):
    cost, (fragile,), _ = kept(("fragile", FRAGILE))
    with pytest.raises(CostError) as failure:
        fragile(at_zero)
    assert failure.value.code == "division_by_zero"
    assert cost.name == "fragile"
    assert np.isfinite(next(iter(cost(sample).values()))).all()
