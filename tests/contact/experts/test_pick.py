"""Which way the hand is turned to grasp from above."""

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.experts.pick import ENOUGH_M, grasp_quaternion, room
from coral.contact.experts.terms import axis

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
    assert room(state((-0.08, 0.0, 0.06)), "carton", np.array(point)) == pytest.approx(expected)
