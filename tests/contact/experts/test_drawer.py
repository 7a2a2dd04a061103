"""A drawer: where its handle is, when a stage is over, which costs fall on the way."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts.abreast import DOWN
from coral.contact.experts.drawer import closing, handle, opened_band, opening, pulled
from coral.contact.tasks import load_task

OPEN, CLOSE = load_task("open-drawer"), load_task("close-drawer")


def test_the_file_says_how_far():
    assert opened_band(OPEN) == (0.08, 0.14)


def drawer_at(state_of, task, by, **changed):
    """The drawer moved towards the robot, the hand at its handle."""
    start = state_of(task)
    way = np.array([-by, 0, 0])
    moved = {key: start[key] + way for key in ("drawer_pos", "drawer_handle_pos")}
    return state_of(task, **{**moved, "ee_pos": handle(start, "drawer") + way, "ee_quat": DOWN, **changed})


def test_pulled_is_the_way_towards_the_robot(state_of):
    assert pulled(drawer_at(state_of, "open-drawer", 0.05), "drawer").item() == pytest.approx(0.05)


def test_the_hand_grips_at_the_handle_and_pulls_what_it_holds(state_of):
    progress = Progress(opening(OPEN))
    assert not progress.update(state_of("open-drawer"))
    there = drawer_at(state_of, "open-drawer", 0.0)
    assert progress.update(there)
    assert not progress.update(there)
    held = drawer_at(state_of, "open-drawer", 0.0, drawer_left_contact=1, drawer_right_contact=1)
    assert progress.update(held)
    assert progress.stage.name == "pull"
    assert progress.update(state_of("open-drawer"))
    assert progress.stage.name == "reach"


@pytest.mark.parametrize(
    ("task", "strategy", "ways"),
    [("open-drawer", opening(OPEN), (0, 0.05, 0.1)), ("close-drawer", closing(CLOSE), (0, -0.03, -0.06))],
)
def test_the_cost_falls_with_the_way(task, strategy, ways, state_of, cost_of):
    stage = next(stage for stage in strategy.stages if stage.name in ("pull", "push"))
    costs = [cost_of(stage, drawer_at(state_of, task, way, gripper_target=0.0)) for way in ways]
    assert costs == sorted(costs, reverse=True)


def test_a_drawer_that_is_shut_is_left(state_of):
    progress = Progress(closing(CLOSE))
    progress.index = 1
    start = state_of("close-drawer")
    assert not progress.update(start)
    shut = start.shut_pos[0, 0] - start.drawer_pos[0, 0]
    assert progress.update(drawer_at(state_of, "close-drawer", -shut[0]))
    assert progress.stage.name == "draw back"
