"""Pushing round: which way the pushed point goes, how far it is, when a stage is over."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts.abreast import ABREAST_M
from coral.contact.experts.swing import Turn, fsm
from coral.contact.tasks import load_task

LEVER = fsm(load_task("turn-lever"), to_deg=82, way=1)
TURN, DOOR = Turn("lever", 82, 1), Turn("door", -160, -1)


def lever_at(state_of, degrees, **changed):
    """The lever at a heading, seen from above; its tip 14 cm from its post."""
    pivot = np.array([0.0, -0.05, 0.052])
    turn = np.radians(degrees)
    tip = pivot + 0.14 * np.array([np.cos(turn), np.sin(turn), 0.0])
    return state_of("turn-lever", lever_pivot_pos=pivot, lever_tip_pos=tip, **changed)


@pytest.mark.parametrize(("degrees", "left"), [(0, 82), (82, 0), (-20, 102), (90, -8)])
def test_the_angle_that_is_left(state_of, degrees, left):
    assert np.degrees(TURN.angle_left(lever_at(state_of, degrees))).item() == pytest.approx(left)


def test_a_door_that_turns_the_other_way_counts_the_other_way(state_of):
    start = state_of("open-door")
    half_open = state_of("open-door", door_tip_pos=start["door_pivot_pos"] + np.array([-0.1, 0.0, 0.0]))
    assert np.degrees(DOOR.angle_left(half_open)).item() == pytest.approx(-20)
    assert DOOR.ahead(half_open)[0, 0] == pytest.approx([0, 1, 0])


def test_the_hand_pushes_from_behind_to_the_left(state_of):
    state = lever_at(state_of, 0)
    assert TURN.ahead(state)[0, 0] == pytest.approx([0, 1, 0])
    off = TURN.behind(state, 0.01) - state["lever_tip_pos"]
    assert off[0, 0] == pytest.approx([0, -0.0325, 0])


def at_it(state_of, degrees):
    state = lever_at(state_of, degrees)
    return lever_at(state_of, degrees, ee_pos=TURN.behind(state), gripper_target=ABREAST_M)


def test_it_pushes_until_the_angle_is_reached_and_draws_back(state_of):
    progress = Progress(LEVER)
    progress.index = 1
    assert not progress.update(at_it(state_of, 40))
    assert progress.update(at_it(state_of, 80))
    assert progress.stage.name == "draw back"


def test_a_hand_beside_the_lever_begins_again(state_of):
    progress = Progress(LEVER)
    progress.index = 1
    assert progress.update(lever_at(state_of, 40))
    assert progress.stage.name == "reach"


def test_the_cost_falls_with_the_angle(state_of, cost_of):
    stage = LEVER.stages[1]
    costs = [cost_of(stage, at_it(state_of, degrees)) for degrees in (0, 1, 2)]
    assert costs == sorted(costs, reverse=True)
