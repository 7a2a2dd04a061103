import numpy as np
from solid_object import solid

from coral.contact.perception.grasp_detection import is_grasped


def box():
    return solid(("box", (0.03, 0.02, 0.03)))


def held(x=0.0, y=0.0, opening=0.04, wanted=-0.03, before=False):
    T = np.eye(4)
    T[:3, 3] = x, y, 0.0
    return is_grasped(box(), T, opening, wanted, before)


def test_fingers_that_press_on_an_object_hold_it():
    assert held()


def test_open_fingers_hold_nothing():
    assert not held(wanted=0.04)


def test_fingers_that_press_on_something_else_do_not_hold_it():
    assert not held(x=0.2)
    assert not held(opening=0.01)


def test_a_grip_is_kept_more_easily_than_made():
    assert not held(y=0.012)
    assert held(y=0.012, before=True)
