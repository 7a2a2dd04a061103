import textwrap

import numpy as np
import pytest
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost_program import CostProgram
from coral.contact.plan.attraction import at_rest, follow_cost
from coral.contact.plan.barrier_check import gate_barriers, nearest_object, touch_barriers
from coral.contact.plan.cost_check import pooled

GATE = """
    def state_cost(self):
        d = norm(self.ee_pos - self.box_pos)
        cost = 5.0 * d  # reach
        if d < {gate}:
            cost += {change}  # close
        return cost
"""
ABSOLUTE = """
    def state_cost(self):
        away = self.ee_pos - self.box_pos
        d = (away[0] ** 2 + away[1] ** 2 + away[2] ** 2) ** 0.5
        return 5.0 * d + (({change}) if d < 0.05 else 0.0)
"""
DESCEND = """
    def state_cost(self):
        beside = norm(self.ee_pos[:2] - self.box_pos[:2])
        height = self.box_pos[2] + 0.1 * clip01(beside / 0.05)
        return {{'over it': 5.0 * beside, 'come down': 10.0 * abs(self.ee_pos[2] - height)}}
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


def program(source, **change):
    return CostProgram(textwrap.dedent(source).strip().format(**{"gate": 0.05, **change}), SCHEMA)


def gates(source, **change):
    cost, values = program(source, **change), at_rest(states())
    return gate_barriers(cost, values, follow_cost(cost, values))


def touches(**change):
    cost, pool = program(TOUCH, **change), states()
    return touch_barriers(cost, pool, follow_cost(cost, at_rest(pool)))


@pytest.mark.parametrize("penalty", ["0.5", "3.0", "100.0"])
def test_a_penalty_near_the_target_that_outweighs_the_rest_of_the_way_is_a_barrier(penalty):
    (fault,) = gates(GATE, change=penalty)
    assert (fault.code, fault.line, fault.fatal) == ("barrier", 0, True)
    assert f"jumps up by {float(penalty):.3g}" in fault.reason
    assert "towards the box" in fault.reason
    assert "0.0" in fault.reason


@pytest.mark.parametrize("gate", [0.12, 0.16, 0.2])
@pytest.mark.parametrize("penalty", [4.0, 10.0])
def test_a_wall_far_from_the_object_is_a_barrier_too(gate, penalty):
    (fault,) = gates(GATE, gate=gate, change=penalty)
    assert f"jumps up by {penalty:.3g}" in fault.reason


@pytest.mark.parametrize("gate", [0.12, 0.16, 0.2])
def test_a_wall_far_from_the_object_that_the_rest_of_the_way_outweighs_is_none(gate):
    assert gates(GATE, gate=gate, change=2.0 * gate) == []


def test_the_same_cost_written_otherwise_gets_the_same_verdict():
    for change in ("0.5", "3.0", "0.2", "-0.5"):
        assert bool(gates(GATE, change=change)) == bool(gates(ABSOLUTE, change=change))


@pytest.mark.parametrize("change", ["-0.5", "0.02", "0.2"])
def test_a_bonus_or_a_penalty_that_the_rest_of_the_way_outweighs_is_none(change):
    assert gates(GATE, change=change) == []


def test_coming_down_while_coming_nearer_is_no_barrier():
    assert gates(DESCEND) == []


def test_an_intended_distance_is_no_barrier():
    assert gates("def state_cost(self):\n    return abs(norm(self.ee_pos - self.box_pos) - 0.05)") == []


def test_a_penalty_on_a_hand_that_is_turned_wrongly_is_no_barrier():
    assert gates(GATE, change="9.0 * (1.0 + quat_axis(self.ee_quat, 2)[2])") == []


def test_a_term_that_begins_with_the_touch_of_the_target_is_a_barrier():
    (fault,) = touches(target="box", change="50.0")
    assert (fault.line, fault.fatal) == (0, True)
    assert "rises by" in fault.reason
    assert "touches it" in fault.reason


def test_a_bonus_for_the_touch_is_no_barrier():
    assert touches(target="box", change="-50.0") == []


def test_a_touch_that_costs_less_than_the_way_gains_is_no_barrier():
    assert touches(target="box", change="0.1") == []


def test_a_touch_of_what_the_hand_is_not_sent_to_may_be_dear():
    assert touches(target="board", change="50.0") == []


def test_the_nearest_object_is_found_with_its_distance():
    values = at_rest(states())
    at = values["box_pos"][0, 0]
    name, distance = nearest_object(values, at)
    assert (name, round(distance, 6)) == ("box", -0.02)
    assert nearest_object(values, at + np.array([0.0, 0.0, 1.0]))[1] > 0.5


@pytest.mark.parametrize(("task", "name"), [("push-force", "block"), ("pick-box", "box")])
@pytest.mark.parametrize("gate", [0.12, 0.2, 0.25])
def test_a_plain_wall_around_the_object_is_found_in_the_scenes_of_tasks(scene, task, name, gate):
    one = scene(task)
    values = at_rest(one.world.present(one.now))
    source = f"def state_cost(self):\n    d = norm(self.ee_pos - self.{name}_pos)\n    return 5.0 * d"
    wall = CostProgram(f"{source} + (4.0 if d < {gate} else 0.0)", one.world.schema)
    free = CostProgram(source, one.world.schema)
    assert [fault.code for fault in gate_barriers(wall, values, follow_cost(wall, values))] == ["barrier"]
    assert gate_barriers(free, values, follow_cost(free, values)) == []
