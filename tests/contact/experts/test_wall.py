"""Flipping against a wall: the wall's face, how far the near end is raised, and the order of the stages."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts.terms import facing
from coral.contact.experts.wall import behind, fsm, raised, single, square, under, wall_face
from coral.contact.scene.geometry import from_rpy_deg
from coral.contact.tasks import load_task

TASK = load_task("flip-wall")
STAGES = fsm(TASK)
FLAT, STANDING = from_rpy_deg([0, 0, 0]), from_rpy_deg([0, 89.9, 0])


def at_wall(state, gap_m=0.0):
    """The position of a lying box whose far face is so far from the wall."""
    x = wall_face(state).item() - gap_m - state.box_size[0, 0, 0] / 2
    return [x, 0.0, state.box_size[0, 0, 2] / 2]


def test_the_wall_faces_the_hand(state_of):
    assert wall_face(state_of("flip-wall")).item() == pytest.approx(0.2)


@pytest.mark.parametrize("degrees", [0, 45, 90])
def test_raised_is_the_sine_of_the_near_ends_angle(degrees, state_of):
    # Pitch lowers the far end, so that the near one comes up.
    state = state_of("flip-wall", box_quat=from_rpy_deg([0, degrees, 0]))
    assert raised(state, "box").item() == pytest.approx(np.sin(np.radians(degrees)), abs=1e-9)


def test_the_hand_pushes_behind_and_lifts_under_the_near_face(state_of):
    state = state_of("flip-wall", box_quat=FLAT)
    near_face = (state.box_pos - state.box_size / 2)[0, 0, 0]
    assert behind(state, "box", 0.02)[0, 0, 0] == pytest.approx(near_face - 0.010 - 0.02)
    assert behind(state, "box")[0, 0, 2] == 0.016
    assert under(state, "box")[0, 0] == pytest.approx([near_face - 0.010, state.box_pos[0, 0, 1], 0.004], abs=1e-4)


def test_the_stages_follow_each_other_as_the_box_goes(state_of):
    start = state_of("flip-wall")
    guide = STAGES.stages[0].guides[0]
    progress = Progress(STAGES)
    names = [progress.stage.name]
    behind_it = state_of("flip-wall", ee_pos=guide.points(start), ee_quat=facing(start, "box"))
    there = {"box_pos": at_wall(start, 0.004), "box_quat": FLAT}
    pushed = state_of("flip-wall", ee_pos=behind(state_of("flip-wall", **there), "box"), **there)
    for state in (start, behind_it, pushed, state_of("flip-wall", box_quat=STANDING)):
        progress.update(state)
        names.append(progress.stage.name)
    assert names == ["reach", "reach", "push", "lift", "let go"]


def test_a_box_that_is_lost_or_falls_is_approached_again(state_of):
    progress = Progress(STAGES)
    progress.index = STAGES.stage("lift")
    assert progress.update(state_of("flip-wall"))  # flat, the hand far away
    assert progress.stage.name == "reach"
    progress.index = STAGES.stage("let go")
    assert not progress.update(state_of("flip-wall", box_quat=STANDING))
    assert progress.update(state_of("flip-wall", box_quat=from_rpy_deg([0, 20, 0])))


def test_raising_pays_at_the_wall_only(state_of):
    (stage,) = single(TASK).stages
    start = state_of("flip-wall")

    def gain(gap_m):
        place = at_wall(start, gap_m)
        state = state_of("flip-wall", box_pos=place, box_quat=from_rpy_deg([0, 45, 0]))
        return -np.asarray(stage.cost(state)["raise"]).item()

    assert gain(0.0) > 2.0
    assert gain(0.15) < 0.1


def test_a_hand_square_to_the_near_face_costs_nothing(state_of):
    state = state_of("flip-wall", box_quat=from_rpy_deg([0, 0, 15]))
    hand = facing(state, "box")
    assert square(
        state_of("flip-wall", box_quat=from_rpy_deg([0, 0, 15]), ee_quat=hand), "box"
    ).item() == pytest.approx(0.0, abs=1e-12)
    assert square(state_of("flip-wall", ee_quat=hand)).item() > 0.1
