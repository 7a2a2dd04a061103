"""Costs that run and yet mislead the planner are found, and good ones pass."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost_program import CostProgram
from coral.contact.cost_program.worker import CostWorker
from coral.contact.plan.attraction import at_rest, follow_cost
from coral.contact.plan.cost_check import containing_body, unreachable, verify_cost

GOOD = """
    def state_cost(self):
        cost = 5.0 * norm(self.ee_pos - self.box_pos)  # reach
        if self.box_left_contact and self.box_right_contact:
            cost -= 3.0  # grasp
        cost += 8.0 * abs(self.box_pos[2] - 0.2)  # lift
        return cost
"""
INSIDE = "def state_cost(self):\n    return 3.0 * norm(self.ee_pos - self.board_pos) - self.time"
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


def check(source, schema):
    program = CostProgram(textwrap.dedent(source), schema)
    faults = verify_cost(program, rolled_out(np.random.default_rng(0)))
    return [fault for fault in faults if fault.fatal]


def test_a_good_cost_passes(schema):
    assert check(GOOD, schema) == []


def test_the_board_example_passes_on_random_states(board, schema):
    program = CostProgram(board, schema)
    faults = verify_cost(program, rolled_out(np.random.default_rng(1)))
    assert [fault.code for fault in faults if fault.fatal] == []


@pytest.mark.parametrize(
    ("source", "code", "line", "words"),
    [
        ("def state_cost(self):\n    return 3.0", "constant", 0, "same for every sampled rollout"),
        ("def state_cost(self):\n    return 1.0 / (self.time * 0.0)", "not_finite", 2, "guard divisions"),
        ("def state_cost(self):\n    return self.bax_pos[0]", "unknown_state", 2, "did you mean 'box_pos'"),
        (GATE, "barrier", 0, "towards the box and jumps up"),
        (TOUCH, "barrier", 0, "when it touches it"),
    ],
)
def test_a_bad_cost_gets_its_reason(source, code, line, words, schema):
    faults = check(source, schema)
    assert [fault.code for fault in faults] == [code]
    assert faults[0].line == line
    assert words in faults[0].reason


def test_the_right_way_to_write_it_passes(schema):
    assert check(BONUS, schema) == []


def test_a_place_inside_a_solid_is_noted_and_not_refused(schema):
    samples = rolled_out(np.random.default_rng(0), thick=0.1)
    faults = verify_cost(CostProgram(INSIDE, schema), samples)
    assert [(fault.code, fault.fatal) for fault in faults] == [("unreachable", False)]


def test_one_cost_has_one_verdict(schema):
    samples, program = rolled_out(np.random.default_rng(0)), CostProgram(textwrap.dedent(GATE), schema)
    first = verify_cost(program, samples)
    assert all(verify_cost(program, samples) == first for _ in range(4))


def test_a_cost_that_is_not_finite_where_no_sample_was_is_not_refused(schema):
    inside = "norm(self.ee_pos - self.box_pos)"
    source = f"def state_cost(self):\n    return {inside} + 0.0 / max(0.0, {inside} - 1e-9)"
    far = rolled_out(np.random.default_rng(0), closest=0.05)
    assert [fault for fault in verify_cost(CostProgram(source, schema), far) if fault.fatal] == []


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


def resting(thick=0.012, **more):
    values = at_rest(rolled_out(np.random.default_rng(0), thick=thick))
    upright = {"board_quat": np.array([[[1.0, 0.0, 0.0, 0.0]]]), "box_quat": np.array([[[1.0, 0.0, 0.0, 0.0]]])}
    return {**values, **upright, **more}


def notes(expression, **scene):
    values = resting(**scene)
    cost = CostProgram(f"def state_cost(self):\n    return {expression}", SCHEMA)
    return unreachable(values, follow_cost(cost, values))


def test_a_place_inside_what_the_fingers_cannot_straddle_is_noted_and_not_refused():
    assert notes("4.0 * norm(self.ee_pos - self.board_pos)") == []
    (note,) = notes("4.0 * norm(self.ee_pos - self.board_pos)", thick=0.1)
    assert (note.code, note.line, note.fatal) == ("unreachable", 0, False)
    assert "0.050 m inside the board" in note.reason


def test_the_same_place_written_without_a_norm_is_noted_alike():
    away = " + ".join(f"abs(self.ee_pos[{k}] - self.board_pos[{k}])" for k in range(3))
    (note,) = notes(away, thick=0.1)
    assert "0.050 m inside the board" in note.reason


def test_the_surface_may_be_aimed_at():
    assert notes("norm(self.ee_pos - (self.board_pos + np.array([0.0, 0.0, 0.045])))", thick=0.1) == []


def test_what_the_fingers_can_straddle_keeps_nothing_away():
    assert notes("norm(self.ee_pos - self.box_pos)") == []


@pytest.mark.parametrize(
    ("point", "body", "depth"),
    [([0.4, 0.0, -0.03], "table", 0.03), ([0.4, 0.0, 0.03], "", 0.015), ([0.6, 0.2, 0.1], "wall", 0.05)],
)
def test_the_body_in_the_way_is_named(point, body, depth):
    scene = {
        "table_min": np.array([[[0.0, -0.5, -0.1]]]),
        "table_max": np.array([[[1.0, 0.5, 0.0]]]),
        "wall_pos": np.array([[[0.6, 0.2, 0.1]]]),
        "wall_size": np.array([[[0.1, 0.4, 0.2]]]),
    }
    found, deep = containing_body(resting(**scene), np.array(point))
    assert (found, round(deep, 6)) == (body, depth)
