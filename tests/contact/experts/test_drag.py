"""Pressing and dragging: where the hand presses, when a stage is over, which costs fall on the way."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts.abreast import DOWN
from coral.contact.experts.drag import TIP_M, fsm, over, to_place
from coral.contact.tasks import load_task

WIPE, STOP = load_task("wipe-to-and-fro"), load_task("slide-to-stop")


def on_it(state_of, name, object_name, at, **changed):
    """The object at a place of the table, the fingertips on it."""
    start = state_of(name)
    way = np.array([*at, 0.0]) - start[f"{object_name}_pos"][0, 0] * [1, 1, 0]
    moved = {key: start[key] + way for key in (f"{object_name}_pos", f"{object_name}_grip_pos")}
    tool = moved[f"{object_name}_grip_pos"] + np.array([0, 0, TIP_M])
    return state_of(name, **{**moved, "ee_pos": tool, "ee_quat": DOWN, "gripper_target": 0.0, **changed})


def test_the_fingertips_lie_on_the_point(state_of):
    state = state_of("wipe-stroke")
    assert over(state, "sponge")[0, 0] - state["sponge_grip_pos"][0, 0] == pytest.approx([0, 0, 0.008])


def test_the_way_is_along_the_table(state_of):
    state = on_it(state_of, "wipe-stroke", "sponge", (0.0, 0.0))
    assert to_place(state, "sponge", "goal")[0, 0] == pytest.approx([0.08, -0.06, 0.0])


def test_each_place_is_wiped_in_the_order_of_the_file(state_of):
    strategy, progress = fsm(WIPE), Progress(fsm(WIPE))
    assert [stage.name for stage in strategy.stages] == ["reach", "drag to left", "drag to right", "let go"]
    assert not progress.update(state_of("wipe-to-and-fro"))
    progress.index = 1
    assert not progress.update(on_it(state_of, "wipe-to-and-fro", "sponge", (0.0, -0.1)))
    assert progress.update(on_it(state_of, "wipe-to-and-fro", "sponge", (0.0, 0.095)))
    assert progress.stage.name == "drag to right"


def test_a_hand_that_slipped_off_begins_again(state_of):
    progress = Progress(fsm(WIPE))
    progress.index = 1
    assert progress.update(on_it(state_of, "wipe-to-and-fro", "sponge", (0.0, 0.0), ee_pos=[0.1, 0.0, 0.05]))
    assert progress.stage.name == "reach"


@pytest.mark.parametrize("touched", [0, 1])
def test_a_stop_ends_the_drag(state_of, touched):
    progress = Progress(fsm(STOP))
    progress.index = 1
    state = on_it(state_of, "slide-to-stop", "tile", (0.0, 0.0), tile_stop_contact=touched)
    assert progress.update(state) is bool(touched)


def test_the_cost_falls_with_the_way_and_with_the_right_pressure(state_of, cost_of):
    stage = fsm(WIPE).stages[1]

    def cost(y, newtons):
        return cost_of(stage, on_it(state_of, "wipe-to-and-fro", "sponge", (0, y), sponge_hand_force=[0, 0, -newtons]))

    assert cost(0.05, 6) < cost(0.0, 6)
    assert cost(0.0, 6) < min(cost(0.0, 2), cost(0.0, 12))
