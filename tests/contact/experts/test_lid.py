"""A lid: where it is pushed, and when it is shut."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts.lid import ajar, closed, fsm, outer
from coral.contact.scene.geometry import from_rpy_deg, rotate
from coral.contact.tasks import load_task

STAGES = fsm(load_task("close-lid"))
HINGE = np.array([0.015, 0.0, 0.085])


def lid_at(state_of, degrees, **changed):
    """The lid opened by an angle, the hand at its outer face."""
    turn = from_rpy_deg([0, -degrees, 0])
    lid = {
        "lid_pos": HINGE + rotate(turn, np.array([0.085, 0, 0])),
        "lid_rim_pos": HINGE + rotate(turn, np.array([0.17, 0, 0])),
        "lid_quat": turn,
    }
    at = outer(state_of("close-lid", **lid), "lid")
    return state_of("close-lid", **{**lid, "ee_pos": at, **changed})


@pytest.mark.parametrize(("degrees", "height"), [(0, 0.085 + 0.015), (90, 0.085 + 0.085 * 1.7)])
def test_the_hand_pushes_the_outer_face(degrees, height, state_of):
    state = lid_at(state_of, degrees)
    assert closed(state, "lid").item() == pytest.approx(np.cos(np.radians(degrees)))
    assert outer(state, "lid")[0, 0, 2] == pytest.approx(height)
    if degrees == 90:
        assert outer(state, "lid")[0, 0, 0] < HINGE[0]  # on the robot's side


def test_ajar_tells_small_angles_apart(state_of):
    gaps = [ajar(lid_at(state_of, degrees), "lid").item() for degrees in (0, 2, 4)]
    assert gaps == pytest.approx(np.radians([0, 2, 4]), abs=1e-4)


def test_the_cost_falls_while_the_lid_closes(state_of, cost_of):
    costs = [cost_of(STAGES.stages[1], lid_at(state_of, degrees)) for degrees in (90, 60, 30, 0)]
    assert costs == sorted(costs, reverse=True)


def test_pressing_costs_from_a_few_newtons_on(state_of, cost_of):
    push = STAGES.stages[1]
    pressed = [cost_of(push, lid_at(state_of, 45, lid_hand_force=[0.0, 0.0, -force])) for force in (0, 5, 15)]
    assert pressed[0] == pytest.approx(pressed[1])
    assert pressed[2] > pressed[1] + 1


def test_a_shut_lid_is_left_and_one_that_opened_again_is_pushed_again(state_of):
    progress = Progress(STAGES)
    progress.index = 1
    assert not progress.update(lid_at(state_of, 10))
    assert progress.update(lid_at(state_of, 1))
    assert progress.stage.name == "let go"
    assert progress.update(lid_at(state_of, 40))
    assert progress.stage.name == "reach"
