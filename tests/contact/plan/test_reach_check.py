import numpy as np
import pytest
from cost_oracles import SCHEMA
from hand_rollouts import rolled_out

from coral.contact.cost_program import CostProgram
from coral.contact.plan.attraction import at_rest, follow_cost
from coral.contact.plan.reach_check import containing_body, unreachable


def resting(thick=0.012, **more):
    values = at_rest(rolled_out(np.random.default_rng(0), thick=thick)[0])
    upright = {"board_quat": np.array([[[1.0, 0.0, 0.0, 0.0]]]), "box_quat": np.array([[[1.0, 0.0, 0.0, 0.0]]])}
    return {**values, **upright, **more}


def notes(expression, **scene):
    values = resting(**scene)
    cost = CostProgram(f"def state_cost(self):\n    return {expression}", SCHEMA)
    return unreachable(cost, values, follow_cost(cost, values))


def test_a_place_inside_what_the_fingers_cannot_straddle_is_noted_and_not_refused():
    assert notes("4.0 * norm(self.ee_pos - self.board_pos)") == []
    (note,) = notes("4.0 * norm(self.ee_pos - self.board_pos)", thick=0.1)
    assert (note.code, note.line, note.fatal) == ("unreachable", 2, False)
    assert "0.050 m inside the board" in note.reason
    assert note.reason.startswith("line 2 (`return 4.0 * norm")


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
