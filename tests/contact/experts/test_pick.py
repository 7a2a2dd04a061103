"""Which way the hand is turned to grasp from above."""

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.experts.pick import ENOUGH_M, fsm, grasp_point, grasp_quaternion, room
from coral.contact.experts.terms import axis
from coral.contact.tasks import load_task

UPRIGHT, DOWN = np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0, 0.0])


def state(carton, can_size=(0.06, 0.06, 0.1)):
    values = {
        "ee_quat": DOWN,
        "can_pos": np.array([0.0, 0.0, 0.05]),
        "can_quat": UPRIGHT,
        "can_size": np.array(can_size),
        "carton_pos": np.array(carton),
        "carton_quat": UPRIGHT,
        "carton_size": np.array([0.06, 0.06, 0.12]),
    }
    return Context({name: value[None, None] for name, value in values.items()}, (1, 1))


@pytest.mark.parametrize(("carton", "along"), [((-0.08, 0.0, 0.06), 1), ((0.0, 0.08, 0.06), 0), ((0.3, 0.3, 0.06), 1)])
def test_a_round_object_is_grasped_where_the_fingers_have_room(carton, along):
    opening = axis(grasp_quaternion(state(carton), "can", ["carton"]), "y")
    assert abs(opening[along]) == pytest.approx(1.0)


def test_a_narrow_object_is_grasped_across_whatever_stands_beside_it():
    beside = state((0.0, 0.08, 0.06), can_size=(0.06, 0.04, 0.1))
    assert abs(axis(grasp_quaternion(beside, "can", ["carton"]), "y")[1]) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("point", "expected"),
    [((-0.05, 0.0, 0.1), 0.0), ((-0.04, 0.0, 0.1), 0.01), ((-0.08, 0.0, 0.13), 0.01), ((0.2, 0.0, 0.1), ENOUGH_M)],
)
def test_room_is_counted_from_the_others_surface(point, expected):
    far = np.array([0.3, 0.3, 0.3])
    for points in ([point, far], [far, point]):  # the nearer of two fingers counts
        assert room(state((-0.08, 0.0, 0.06)), ["carton"], np.array(points)) == pytest.approx(expected)


def test_the_grasp_is_at_the_middle_where_a_task_names_it():
    held = state((0.3, 0.3, 0.06))
    np.testing.assert_allclose(grasp_point(held, "can")[0, 0], [0.0, 0.0, 0.075])
    offset = Context({**dict(held._values), "can_middle_pos": np.array([[[0.0, -0.004, 0.04]]])}, (1, 1))
    np.testing.assert_allclose(grasp_point(offset, "can")[0, 0], [0.0, -0.004, 0.065])


@pytest.mark.parametrize(("numbers", "first"), [({}, "reach"), ({"hover_height": 0.05}, "align")])
def test_a_task_may_ask_for_a_rest_above_the_object(numbers, first):
    task = load_task("pick-box")
    stages = fsm(task.model_copy(update={"numbers": {**task.numbers, **numbers}})).stages
    assert stages[0].name == first
    assert {stage.next[0][0] for stage in stages if stage.next} == {first}


@pytest.mark.parametrize(
    ("tool", "ready"), [((0.002, 0.0, 0.135), True), ((0.005, 0.0, 0.125), False), ((0, 0, 0.16), False)]
)
def test_the_hand_goes_down_once_it_rests_over_the_grasp(tool, ready):
    task = load_task("pick-box")
    item = task.objects[0].model_copy(update={"name": "can"})
    task = task.model_copy(update={"objects": (item,), "numbers": {"hover_height": 0.05}})
    now = state((0.3, 0.3, 0.06))
    now = Context({**dict(now._values), "ee_pos": np.array([[tool]])}, (1, 1))
    assert fsm(task).stages[0].until(now) is ready
