"""Pick and place: which tasks it is for, and the order of its stages."""

import numpy as np
import pytest

from coral.contact.cost.stages import Progress
from coral.contact.experts import pick
from coral.contact.experts.place import CARRY_M, fsm, places, single
from coral.contact.tasks import load_task

TASK = load_task("pick-clutter")
STAGES = fsm(TASK)


@pytest.fixture
def held(state_of):
    """The can between the fingers, somewhere."""

    def place(position, **changed):
        state = state_of("pick-clutter", can_pos=position)
        return state_of(
            "pick-clutter",
            **{
                "can_pos": position,
                "can_left_contact": 1,
                "can_right_contact": 1,
                "can_table_contact": 0,
                "gripper_target": 0.0,
                "gripper_opening": 0.05,
                "ee_pos": pick.grasp_point(state, "can"),
                **changed,
            },
        )

    return place


@pytest.mark.parametrize(("name", "wanted"), [("pick-clutter", True), ("pick-box", False), ("push-force", False)])
def test_only_tasks_that_put_their_first_object_at_the_goal_are_to_place(name, wanted):
    assert places(load_task(name)) is wanted


def test_a_task_that_does_not_let_go_is_none_to_place():
    kept = tuple(one for one in TASK.success.conditions if one.kind != "released")
    assert not places(TASK.model_copy(update={"success": TASK.success.model_copy(update={"conditions": kept})}))


def test_the_stages_follow_each_other_as_the_can_goes(held):
    progress = Progress(STAGES)
    progress.index = STAGES.stage("raise")
    names = []
    for state in (
        held([0.0, 0.1, 0.05]),
        held([0.0, 0.1, CARRY_M]),
        held([0.1, -0.19, CARRY_M]),
        held([0.1, -0.2, 0.06]),
        held([0.1, -0.2, 0.05], can_mat_contact=1),
        held([0.1, -0.2, 0.05], gripper_opening=0.08),
    ):
        progress.update(state)
        names.append(progress.stage.name)
    assert names == ["raise", "carry", "lower", "lower", "release", "retire"]


@pytest.mark.parametrize("name", ["raise", "carry", "lower"])
def test_a_lost_can_is_reached_for_again(name, held):
    progress = Progress(STAGES)
    progress.index = STAGES.stage(name)
    progress.update(held([0.0, 0.1, 0.05], ee_pos=[0.1, -0.2, 0.2]))
    assert progress.stage.name == "reach"


def test_guides_lead_the_hand_as_the_can_is_to_go(held):
    state = held([0.0, 0.1, 0.05])
    offset = (state.ee_pos - state.can_pos)[0, 0]
    lying = 0.004 + state.can_size[0, 0, 2] / 2
    ends = {
        name: STAGES.stages[STAGES.stage(name)].guides[0].points(state)[0] - offset
        for name in ("raise", "carry", "lower")
    }
    assert ends["raise"] == pytest.approx([0.0, 0.1, CARRY_M])
    assert ends["carry"] == pytest.approx([0.1, -0.2, CARRY_M])
    assert ends["lower"] == pytest.approx([0.1, -0.2, lying])


def test_a_goal_behind_a_rim_is_reached_over_the_rim(held):
    higher = fsm(TASK.model_copy(update={"numbers": {"carry_height": 0.25}}))
    state = held([0.0, 0.1, 0.05])
    end = higher.stages[higher.stage("carry")].guides[0].points(state)[0] - (state.ee_pos - state.can_pos)[0, 0]
    assert end[2] == pytest.approx(0.25)


def test_moving_what_stands_around_costs_in_every_stage_that_carries(held, cost_of):
    for name in ("reach", "close", "raise", "carry", "lower", "retire"):
        stage = STAGES.stages[STAGES.stage(name)]
        still = held([0.0, 0.1, 0.1])
        bumped = held([0.0, 0.1, 0.1], carton_vel=[0.2, 0.0, 0.0])
        assert cost_of(stage, bumped) - cost_of(stage, still) == pytest.approx(3.0 * 0.2), name


def test_one_cost_falls_all_the_way_to_the_goal(held, cost_of):
    (stage,) = single(TASK).stages
    lying = 0.004 + held([0.0, 0.1, 0.05]).can_size[0, 0, 2] / 2
    way = (
        [0.0, 0.1, 0.05],
        [0.0, 0.1, 0.09],
        [0.0, 0.1, CARRY_M],
        [0.06, -0.1, CARRY_M],
        [0.1, -0.2, CARRY_M],
        [0.1, -0.2, lying],
    )
    costs = [cost_of(stage, held(place, can_init_pos=[0.0, 0.1, 0.05])) for place in way]
    assert costs == sorted(costs, reverse=True)


def test_the_next_guide_of_one_cost_is_the_grasp_then_up_then_over_then_down(held):
    (stage,) = single(TASK).stages
    onward = stage.guides[-1].points
    free = held([0.0, 0.1, 0.05], can_left_contact=0)
    assert onward(free) == pytest.approx(pick.grasp_point(free, "can")[0])
    low, high, over = held([0.0, 0.1, 0.05]), held([0.0, 0.1, CARRY_M]), held([0.1, -0.2, CARRY_M])
    assert [len(onward(state)) for state in (low, high, over)] == [2, 1, 2]
    down = onward(over)[0] - (over.ee_pos - over.can_pos)[0, 0]
    assert down == pytest.approx([0.1, -0.2, 0.004 + np.asarray(over.can_size)[0, 0, 2] / 2])


@pytest.mark.parametrize(("tip_m", "released"), [(0.005, True), (0.02, False)])
def test_a_peg_is_released_once_it_is_deep_enough_and_not_at_the_rim(tip_m, released, state_of):
    progress = Progress(fsm(load_task("insert-peg")))
    progress.index = 4
    peg = np.array([0.1, -0.12, tip_m + 0.055])
    now = state_of(
        "insert-peg",
        peg_pos=peg,
        peg_tip_pos=peg - [0, 0, 0.055],
        peg_well_left_contact=1,
        ee_pos=pick.grasp_point(state_of("insert-peg", peg_pos=peg), "peg"),
    )
    assert progress.stage.name == "lower"
    progress.update(now)
    assert (progress.stage.name == "release") is released


def test_a_block_is_released_on_the_block_that_it_is_stacked_on(state_of):
    progress = Progress(fsm(load_task("stack-blocks")))
    progress.index = 4
    top = np.array([0.08, -0.1, 0.08])
    changed = {"top_pos": top, "ee_pos": pick.grasp_point(state_of("stack-blocks", top_pos=top), "top")}
    assert not progress.update(state_of("stack-blocks", top_table_contact=0, **changed))
    assert progress.update(state_of("stack-blocks", top_table_contact=0, top_base_contact=1, **changed))
