"""Flipping a standing box: where it is pushed, what counts as tipped, and when a stage is over."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts.flip import HIGH, ahead, behind, facing, fsm, single, tipped
from coral.contact.scene.geometry import from_rpy_deg, multiply
from coral.contact.tasks import load_task

TASK = load_task("flip-box")
STAGES = fsm(TASK)


def leaning(state, degrees):
    """The box turned about its far lower edge's direction, as a push tips it."""
    return multiply(state.box_init_quat[0, 0], from_rpy_deg([0, degrees, 0]))


@pytest.mark.parametrize("degrees", [0, 30, 90])
def test_tipped_is_the_sine_of_the_lean_ahead(degrees, state_of):
    start = state_of("flip-box")
    state = state_of("flip-box", box_quat=leaning(start, degrees))
    assert tipped(state, "box").item() == pytest.approx(np.sin(np.radians(degrees)), abs=1e-9)


def test_the_push_goes_ahead_from_behind_the_upper_part(state_of):
    state = state_of("flip-box")
    point, box = behind(state, "box")[0, 0], state.box_pos[0, 0]
    assert (point - box) @ ahead(state, "box")[0, 0] < -state.box_size[0, 0, 0] / 2
    assert point[2] == pytest.approx(box[2] + HIGH * state.box_size[0, 0, 2] / 2)
    assert behind(state, "box", 0.02)[0, 0] == pytest.approx(point - 0.02 * ahead(state, "box")[0, 0])


def test_a_hand_where_the_guide_leads_has_arrived_and_tips(state_of):
    start = state_of("flip-box")
    guide = STAGES.stages[0].guides[0]
    there = state_of("flip-box", ee_pos=guide.points(start), ee_quat=facing(start, "box"))
    progress = Progress(STAGES)
    assert not progress.update(start)
    assert progress.update(there)
    assert progress.stage.name == "tip"


def test_a_falling_box_is_left_and_a_box_that_stands_again_is_tried_again(state_of):
    start = state_of("flip-box")
    progress = Progress(STAGES)
    progress.index = 1
    point = behind(start, "box")
    half = state_of("flip-box", box_quat=leaning(start, 30), ee_pos=point)
    fallen = state_of("flip-box", box_quat=leaning(start, 60))
    assert not progress.update(half)
    assert progress.update(fallen)
    assert progress.stage.name == "draw back"
    assert not progress.update(fallen)
    assert progress.update(start)
    assert progress.stage.name == "reach"


@pytest.mark.parametrize("strategy", [single(TASK), STAGES])
def test_the_tipping_cost_falls_while_the_box_leans_further(strategy, state_of, cost_of):
    stage = next(stage for stage in strategy.stages if stage.name in ("flip", "tip"))
    start = state_of("flip-box")
    costs = []
    for degrees in (0, 30, 60, 90):
        lean = state_of("flip-box", box_quat=leaning(start, degrees))
        costs.append(cost_of(stage, state_of("flip-box", box_quat=leaning(start, degrees), ee_pos=behind(lean, "box"))))
    assert costs == sorted(costs, reverse=True)
