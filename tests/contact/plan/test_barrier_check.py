import textwrap

import numpy as np
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost_program import CostProgram
from coral.contact.plan.barrier_check import contact_barriers, path_barriers
from coral.contact.plan.cost_check import pooled
from coral.contact.plan.cost_fault import CostCheckCfg
from coral.contact.plan.reach_check import find_reach_terms, with_quantities

GATE = """
    def state_cost(self):
        d = norm(self.ee_pos - self.box_pos)
        cost = 5.0 * d  # reach
        if d < 0.05:
            cost += {change}  # close
        return cost
"""
SLOPE = """
    def state_cost(self):
        d = norm(self.ee_pos - self.box_pos)
        return {{'reach': 2.0 * d, 'fear': {change}}}
"""
TOUCH = """
    def state_cost(self):
        cost = 2.0 * norm(self.ee_pos - self.{target}_pos)  # reach
        if self.box_hand_contact:
            cost += {change} * norm(self.box_pos - np.array([0.4, 0.3, 0.2]))  # carry
        return cost
"""


def states():
    return pooled(rolled_out(np.random.default_rng(0)), 200)


def found(check, source, pool, **change):
    cost = CostProgram(textwrap.dedent(source).strip().format(**change), SCHEMA)
    return check(cost, pool, find_reach_terms(cost, pool), CostCheckCfg())


def test_a_penalty_that_begins_near_the_target_is_a_barrier():
    (fault,) = found(path_barriers, GATE, states(), change="0.5")
    assert (fault.code, fault.line, fault.fatal) == ("barrier", 5, True)
    assert "'close' begins only when the hand is near its target and adds up to 0.5 there" in fault.reason


def test_a_bonus_or_a_small_penalty_near_the_target_is_no_barrier():
    assert found(path_barriers, GATE, states(), change="-0.5") == []
    assert found(path_barriers, GATE, states(), change="0.02") == []


def test_a_term_that_rises_all_the_way_begins_nowhere():
    assert found(path_barriers, SLOPE, states(), change="0.3 * exp(-10.0 * d)") == []
    assert found(path_barriers, SLOPE, states(), change="0.3 * near(d, 0.03)") != []


def test_a_cost_of_one_term_that_rises_near_its_target_is_a_barrier():
    source = "def state_cost(self):\n    return abs(norm(self.ee_pos - self.box_pos) - 0.05)"
    (fault,) = found(path_barriers, source, states())
    assert fault.line == 2
    assert "the cost rises by 0.0" in fault.reason


def test_a_hand_that_never_was_far_from_the_target_shows_no_barrier():
    pool = states()
    near = with_quantities(pool, {"ee_pos": pool["box_pos"] + np.array([0.0, 0.0, 0.1])})
    assert found(path_barriers, GATE, near, change="0.5") == []


def test_a_term_that_begins_with_the_touch_of_the_target_is_a_barrier():
    (fault,) = found(contact_barriers, TOUCH, states(), target="box", change="50.0")
    assert fault.line == 4
    assert "'carry' begins when the hand touches the box" in fault.reason


def test_a_bonus_for_the_touch_is_no_barrier():
    assert found(contact_barriers, TOUCH, states(), target="box", change="-50.0") == []


def test_a_touch_of_what_the_hand_is_not_sent_to_may_be_dear():
    assert found(contact_barriers, TOUCH, states(), target="board", change="50.0") == []
