"""The cutting board: how far it overhangs, where it is pushed and pinched, and the order of the stages."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts.board import (
    DOWN_WIDE,
    PINCH,
    POINTING,
    behind,
    edge,
    fsm,
    grip,
    push_terms,
    single,
)
from coral.contact.experts.terms import axis
from coral.contact.tasks import load_task

TASK = load_task("push-pick-board")
STAGES = fsm(TASK)
UPRIGHT = [1.0, 0.0, 0.0, 0.0]


@pytest.fixture
def board(state_of):
    """The board straight on the table, its handle so far beyond the left edge."""

    def place(overhang_m, **changed):
        state = state_of("push-pick-board")
        y = state.table_max[0, 0, 1] + overhang_m - 0.2
        return state_of(
            "push-pick-board",
            **{
                "board_pos": [0.0, y, 0.006],
                "board_init_pos": [0.0, -0.05, 0.006],
                "board_quat": UPRIGHT,
                "board_handle_pos": [0.0, y + 0.2, 0.006],
                "board_rear_pos": [0.0, y - 0.14, 0.006],
                **changed,
            },
        )

    return place


def test_the_overhang_is_the_handles_way_beyond_the_left_edge(board):
    assert edge(board(0.03)).item() == pytest.approx(0.03)
    assert edge(board(-0.1)).item() == pytest.approx(-0.1)


def test_the_hand_pushes_from_behind_the_rear_edge(board):
    state = board(0.0)
    assert behind(state, 0.03)[0, 0] == pytest.approx([0.0, state.board_rear_pos[0, 0, 1] - 0.03, 0.014])


def test_the_pinch_points_at_the_handle_with_its_opening_upright():
    assert axis(PINCH, "z") == pytest.approx(POINTING)
    assert axis(PINCH, "y") == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)


def test_pushing_is_cheapest_at_the_wanted_overhang(board):
    costs = [push_terms(board(overhang), 0.05)["overhang"].item() for overhang in (-0.05, 0.02, 0.05, 0.09)]
    assert costs == pytest.approx([2.0, 0.6, 0.0, 1.2], abs=1e-9)
    assert push_terms(board(0.05, board_init_pos=[0.03, 0.0, 0.006]), 0.05)["straight"].item() == pytest.approx(0.15)


def test_the_stages_follow_each_other_as_the_board_goes(board):
    progress = Progress(STAGES)
    names = []
    start = board(-0.1)
    over = {"ee_quat": PINCH, "gripper_target": -0.04, "board_left_contact": 1, "board_right_contact": 1}
    ends = {stage.name: stage.guides[0].points for stage in STAGES.stages}
    out = board(0.05)
    for state in (
        board(-0.1, ee_pos=ends["approach"](start), ee_quat=DOWN_WIDE),
        board(0.0),
        out,
        board(0.05, ee_pos=ends["rise"](out), ee_quat=DOWN_WIDE),
        board(0.05, ee_pos=ends["turn"](out), ee_quat=PINCH),
        board(0.05, ee_pos=ends["descend"](out), ee_quat=PINCH),
        board(0.05, ee_pos=ends["insert"](out), ee_quat=PINCH),
        board(0.05, ee_pos=grip(out), **over),
    ):
        progress.update(state)
        names.append(progress.stage.name)
    assert names == ["push", "push", "rise", "turn", "descend", "insert", "pinch", "lift"]


def test_a_board_that_slid_back_is_pushed_again_and_a_lost_grip_is_renewed(board):
    progress = Progress(STAGES)
    progress.index = STAGES.stage("turn")
    progress.update(board(0.02))
    assert progress.stage.name == "approach"
    progress.index = STAGES.stage("lift")
    held = board(0.05, ee_pos=grip(board(0.05)))
    assert not progress.update(held)
    progress.update(board(0.05))  # the hand far away
    assert progress.stage.name == "turn"


def test_one_cost_pushes_first_and_picks_once_the_handle_overhangs(board):
    (stage,) = single(TASK).stages

    def share(state, part):
        return sum(abs(np.asarray(term).item()) for name, term in stage.cost(state).items() if name.startswith(part))

    before, after = board(-0.1), board(0.06)
    assert share(before, "push") > 1.0
    assert share(before, "pick") < 1e-3
    assert share(after, "push") < 0.1
    assert share(after, "pick") > 1.0
