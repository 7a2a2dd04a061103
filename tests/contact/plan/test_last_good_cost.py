import numpy as np
import pytest
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError, CostProgram
from coral.contact.plan.last_good_cost import LastGoodCost

GOOD = "def state_cost(self):\n    return {'reach': 5.0 * norm(self.ee_pos - self.box_pos)}"
BARRIER = """def state_cost(self):
    d = norm(self.ee_pos - self.box_pos)
    cost = 5.0 * d  # reach
    if d < 0.05:
        cost += 20.0 * self.gripper_opening  # close
    return cost
"""
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


def test_without_a_cost_there_is_nothing_to_plan_with(sample):
    cost = LastGoodCost(failed=lambda bad, error: None)
    assert cost.name == "none"
    with pytest.raises(CostError, match="no cost"):
        cost(sample)


def test_the_only_cost_stays_in_use_and_its_error_is_raised(sample, at_zero):
    cost = LastGoodCost(failed=lambda bad, error: None)
    stage = cost.following(program(FRAGILE, "fragile"))
    with pytest.raises(CostError) as failure:
        stage(at_zero)
    assert failure.value.code == "division_by_zero"
    assert cost.name == "fragile"
    assert np.isfinite(next(iter(stage(sample).values()))).all()


def test_a_stage_whose_cost_failed_goes_on_with_the_last_good_one(sample, at_zero):
    told = []
    cost = LastGoodCost(failed=lambda bad, error: told.append((bad.name, error.code)))
    cost.following(program(GOOD, "good"))(sample)
    stage = cost.following(program(FRAGILE, "fragile"))
    assert cost.name == "good"
    stage(sample)
    assert cost.name == "fragile"
    assert list(stage(at_zero)) == ["reach"]
    assert list(stage(sample)) == ["reach"]
    assert (cost.name, told) == ("good", [("fragile", "division_by_zero")])
