import numpy as np
import pytest
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost_program import CostProgram
from coral.contact.plan.cost_check import pooled
from coral.contact.plan.cost_fault import CostCheckCfg
from coral.contact.plan.reach_check import find_reach_terms, rotations, unreachable
from coral.contact.scene.geometry import rotation_of

WIDE = "4.0 * norm(self.ee_pos - self.board_pos) - self.time"
BOX = "3.0 * norm(self.ee_pos - self.box_pos) - self.time"


def costing(expression):
    return CostProgram(f"def state_cost(self):\n    return {expression}", SCHEMA)


def pool(closest=0.0, thick=0.012):
    return pooled(rolled_out(np.random.default_rng(0), closest, thick), 100)


def faults(expression, closest=0.0, thick=0.012):
    cost, states = costing(expression), pool(closest, thick)
    return unreachable(cost, states, find_reach_terms(cost, states), CostCheckCfg())


@pytest.mark.parametrize(
    ("expression", "offset"),
    [
        ("norm(self.ee_pos - self.box_pos)", [0.0, 0.0, 0.0]),
        ("2.0 * norm(self.box_pos - self.ee_pos) + self.time", [0.0, 0.0, 0.0]),
        ("norm(self.ee_pos - (self.box_pos + np.array([0.0, 0.1, 0.2])))", [0.0, 0.1, 0.2]),
    ],
)
def test_the_target_of_a_distance_is_found_however_it_is_written(expression, offset):
    states = pool()
    (found,) = find_reach_terms(costing(expression), states)
    target = states["box_pos"][:, 0] + offset
    np.testing.assert_allclose(found.target, target, atol=1e-12)
    np.testing.assert_allclose(found.value, np.linalg.norm(states["ee_pos"][:, 0] - target, axis=1))
    assert found.line == 2


def test_a_distance_in_the_plane_has_its_target_at_the_height_of_the_hand():
    states = pool()
    (found,) = find_reach_terms(costing("norm(self.ee_pos[:2] - self.box_pos[:2])"), states)
    np.testing.assert_allclose(found.target[:, :2], states["box_pos"][:, 0, :2], atol=1e-12)
    np.testing.assert_array_equal(found.target[:, 2], states["ee_pos"][:, 0, 2])


@pytest.mark.parametrize(
    "expression",
    [
        "norm(self.box_pos - self.board_pos)",
        "-1.0 * norm(self.ee_pos - self.box_pos)",
        "norm(2.0 * (self.ee_pos - self.box_pos))",
        "norm(self.ee_vel - self.box_pos)",
    ],
)
def test_a_distance_without_the_hand_or_one_that_pays_is_no_reach_term(expression):
    assert find_reach_terms(costing(expression), pool()) == []


def test_what_a_reach_term_saves_is_its_whole_share_of_the_cost():
    (found,) = find_reach_terms(costing(BOX), pool())
    np.testing.assert_allclose(found.saved, 3.0 * found.value)


def test_a_target_inside_what_the_fingers_cannot_straddle_is_found():
    assert faults(WIDE) == []
    (fault,) = faults(WIDE, thick=0.1)
    assert (fault.code, fault.line, fault.fatal) == ("unreachable", 2, True)
    assert "0.050 m inside the board" in fault.reason


def test_a_target_that_a_contact_keeps_the_hand_from_is_found():
    assert faults(BOX) == []
    (fault,) = faults(BOX, closest=0.03)
    assert "cannot come below 0.030 m" in fault.reason


def test_a_hand_that_is_stopped_far_from_the_target_proves_nothing():
    assert faults(BOX, closest=0.1) == []


def test_a_line_with_two_such_distances_is_reported_once():
    assert len(faults(f"{BOX} + norm(self.box_pos - self.ee_pos)", closest=0.03)) == 1


def test_rotations_of_a_batch_are_those_of_each_quaternion():
    quats = np.random.default_rng(0).normal(size=(5, 4))
    expected = [rotation_of(quat / np.linalg.norm(quat)) for quat in quats]
    np.testing.assert_allclose(rotations(quats), expected, atol=1e-12)
