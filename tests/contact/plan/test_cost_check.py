"""Costs that run and yet mislead the planner are found, and good ones pass."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError, CostProgram, CostWorker
from coral.contact.plan.cost_check import verify_cost
from coral.contact.plan.last_good_cost import LastGoodCost

GOOD = """
    def state_cost(self):
        cost = 5.0 * norm(self.ee_pos - self.box_pos)  # reach
        if self.box_left_contact and self.box_right_contact:
            cost -= 3.0  # grasp
        cost += 8.0 * abs(self.box_pos[2] - 0.2)  # lift
        return cost
"""
WIDE = "def state_cost(self):\n    return 4.0 * norm(self.ee_pos - self.board_pos) - self.time"
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


def rolled_out(states, schema, rng, closest=0.0, thick=0.012):
    """Rollouts of a hand that comes to a 4 cm box on the table; at the distance `closest` the table stops it."""
    k, h = 20, 12
    state = states(rng, k, h)
    values = {name: state[name] for name in state.names()}
    box = np.broadcast_to(np.array([0.4, 0.0, 0.02]), (k, h, 3)) + rng.normal(size=(k, 1, 3)) * 0.01
    away = rng.normal(size=(k, 1, 3))
    away[..., 2] = np.abs(away[..., 2]) + 1.0
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    distance = np.maximum(np.linspace(0.3, 0.0, h)[None, :, None] * rng.uniform(0.7, 1.3, (k, 1, 1)), closest)
    values["box_pos"], values["ee_pos"] = box, box + away * distance
    values["ee_force"] = np.where(distance <= closest, 3.0 * away, 0.0) * np.ones((k, h, 1))
    near = (distance[..., 0] <= 0.03) * np.ones((k, h))
    for part in ("hand", "left", "right"):
        values[f"box_{part}_contact"] = near
    values["gripper_opening"] = rng.uniform(0.0, 0.08, (k, h))
    values["box_size"] = np.array([[[0.04, 0.04, 0.04]]])
    values["board_size"] = np.array([[[0.3, 0.2, thick]]])
    values["board_pos"] = np.broadcast_to(np.array([0.4, 0.3, 0.05]), (k, h, 3))
    return [Context(values, (k, h))]


def check(source, states, schema, closest=0.0, thick=0.012):
    program = CostProgram(textwrap.dedent(source), schema)
    faults = verify_cost(program, rolled_out(states, schema, np.random.default_rng(0), closest, thick))
    return [fault for fault in faults if fault.fatal]


def test_a_good_cost_passes(states, schema):
    assert check(GOOD, states, schema) == []


def test_a_target_inside_what_the_fingers_cannot_straddle_is_found(states, schema):
    assert check(WIDE, states, schema) == []
    faults = check(WIDE, states, schema, thick=0.1)
    assert [(fault.code, fault.line) for fault in faults] == [("unreachable", 2)]
    assert "0.050 m inside the board" in faults[0].reason


def test_the_board_example_passes_on_random_states(board, states, schema):
    program = CostProgram(board, schema)
    faults = verify_cost(program, rolled_out(states, schema, np.random.default_rng(1)))
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
def test_a_bad_cost_gets_its_reason(source, closest, code, line, words, states, schema):
    faults = check(source, states, schema, closest)
    assert [fault.code for fault in faults] == [code]
    assert faults[0].line == line
    assert words in faults[0].reason


@pytest.mark.parametrize(("source", "closest"), [(BLOCKED, 0.0), (OFFSET, 0.03), (BONUS, 0.0)])
def test_the_right_way_to_write_it_passes(source, closest, states, schema):
    assert check(source, states, schema, closest) == []


def test_a_term_that_never_changes_is_a_note_only(states, schema):
    program = CostProgram("def state_cost(self):\n    return {'reach': norm(self.ee_pos), 'flat': 2.0}", schema)
    faults = verify_cost(program, rolled_out(states, schema, np.random.default_rng(0)))
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
def test_any_cost_is_checked_for_its_shape(terms, code, states, schema):
    faults = verify_cost(Expert(terms), rolled_out(states, schema, np.random.default_rng(0)))
    assert [fault.code for fault in faults] == [code]


def test_a_cost_in_a_worker_is_verified_alike(states, schema):
    samples = rolled_out(states, schema, np.random.default_rng(0))
    source = textwrap.dedent(GATE)
    with CostWorker() as worker:
        assert verify_cost(worker.load(source, schema), samples) == verify_cost(CostProgram(source, schema), samples)


def test_the_plan_goes_on_with_the_last_good_cost(states, schema):
    samples = rolled_out(states, schema, np.random.default_rng(0))
    told = []
    cost = LastGoodCost(failed=lambda bad, error: told.append((bad.name, error.code)))
    with pytest.raises(CostError, match="no cost"):
        cost(samples[0])
    assert cost.propose(CostProgram(textwrap.dedent(GOOD), schema, "good"), samples) == []
    assert cost.propose(CostProgram(textwrap.dedent(GATE), schema, "gate"), samples)[0].fatal
    assert cost.name == "good"
    fragile = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos) + 1.0 / max(0.0, self.time)"
    assert cost.propose(CostProgram(fragile, schema, "fragile"), samples) == []
    assert cost.name == "fragile"
    later = Context({**{n: samples[0][n] for n in samples[0].names()}, "time": np.zeros((20, 12))}, (20, 12))
    assert list(cost(later)) == ["reach", "grasp", "lift"]
    assert (cost.name, told) == ("good", [("fragile", "not_finite")])
