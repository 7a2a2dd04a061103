"""Costs that run and yet mislead the planner are found, and good ones pass."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest
from hand_rollouts import rolled_out

from coral.contact.cost_program import CostProgram, CostWorker
from coral.contact.plan.cost_check import verify_cost

GOOD = """
    def state_cost(self):
        cost = 5.0 * norm(self.ee_pos - self.box_pos)  # reach
        if self.box_left_contact and self.box_right_contact:
            cost -= 3.0  # grasp
        cost += 8.0 * abs(self.box_pos[2] - 0.2)  # lift
        return cost
"""
BLOCKED = "def state_cost(self):\n    reach = 3.0 * norm(self.ee_pos - self.box_pos)\n    return reach - self.time"
OFFSET = "def state_cost(self):\n    r = max(0.0, norm(self.ee_pos - self.box_pos) - 0.04)\n    return r - self.time"
GATE = """
    def state_cost(self):
        d = norm(self.ee_pos - self.box_pos)
        cost = 5.0 * d  # reach
        if d < 0.05:
            cost += 20.0 * self.gripper_opening  # close
        return cost
"""
BONUS = """
    def state_cost(self):
        d = norm(self.ee_pos - self.box_pos)
        cost = 5.0 * d  # reach
        if d < 0.05:
            cost -= 20.0 * (0.08 - self.gripper_opening)  # close
        return cost
"""
TOUCH = """
    def state_cost(self):
        cost = 2.0 * norm(self.ee_pos - self.box_pos)  # reach
        if self.box_hand_contact:
            cost += 50.0 * norm(self.box_pos - np.array([0.4, 0.3, 0.2]))  # carry
        return cost
"""


def check(source, schema, closest=0.0):
    program = CostProgram(textwrap.dedent(source), schema)
    faults = verify_cost(program, rolled_out(np.random.default_rng(0), closest))
    return [fault for fault in faults if fault.fatal]


def test_a_good_cost_passes(schema):
    assert check(GOOD, schema) == []


def test_the_board_example_passes_on_random_states(board, schema):
    program = CostProgram(board, schema)
    faults = verify_cost(program, rolled_out(np.random.default_rng(1)))
    assert [fault.code for fault in faults if fault.fatal] == []


@pytest.mark.parametrize(
    ("source", "closest", "code", "line", "words"),
    [
        ("def state_cost(self):\n    return 3.0", 0.0, "constant", 0, "same for every sampled rollout"),
        ("def state_cost(self):\n    return 1.0 / (self.time * 0.0)", 0.0, "not_finite", 2, "guard divisions"),
        ("def state_cost(self):\n    return self.bax_pos[0]", 0.0, "unknown_state", 2, "did you mean 'box_pos'"),
        (BLOCKED, 0.03, "unreachable", 2, "cannot come below 0.030 m"),
        (GATE, 0.0, "barrier", 5, "'close' begins only when the hand is near"),
        (TOUCH, 0.0, "barrier", 4, "'carry' begins when the hand touches the box"),
    ],
)
def test_a_bad_cost_gets_its_reason(source, closest, code, line, words, schema):
    faults = check(source, schema, closest)
    assert [fault.code for fault in faults] == [code]
    assert faults[0].line == line
    assert words in faults[0].reason


@pytest.mark.parametrize(("source", "closest"), [(BLOCKED, 0.0), (OFFSET, 0.03), (BONUS, 0.0)])
def test_the_right_way_to_write_it_passes(source, closest, schema):
    assert check(source, schema, closest) == []


def test_a_term_that_never_changes_is_a_note_only(schema):
    program = CostProgram("def state_cost(self):\n    return {'reach': norm(self.ee_pos), 'flat': 2.0}", schema)
    faults = verify_cost(program, rolled_out(np.random.default_rng(0)))
    assert [(fault.code, fault.fatal) for fault in faults] == [("constant", False)]
    assert "'flat' is 2 in every sampled state" in faults[0].reason


class Expert:
    name = "expert"

    def __init__(self, terms):
        self.terms = terms

    def __call__(self, state):
        return self.terms


@pytest.mark.parametrize(
    ("terms", "code"),
    [
        ({}, "shape"),
        ({"a": np.zeros(3)}, "shape"),
        ({"a": np.full((20, 12), np.nan)}, "not_finite"),
        ({"a": np.zeros((7, 12))}, "shape"),
        ({"a": np.array([["x"]])}, "shape"),
    ],
)
def test_any_cost_is_checked_for_its_shape(terms, code, schema):
    faults = verify_cost(Expert(terms), rolled_out(np.random.default_rng(0)))
    assert [fault.code for fault in faults] == [code]


def test_a_cost_in_a_worker_is_verified_alike(schema):
    samples = rolled_out(np.random.default_rng(0))
    source = textwrap.dedent(GATE)
    with CostWorker() as worker:
        assert verify_cost(worker.load(source, schema), samples) == verify_cost(CostProgram(source, schema), samples)
