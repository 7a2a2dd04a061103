"""Angles and planar frames."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.reef.world.geometry import Pose, to_robot, to_world, wrap

PLACE = st.floats(-50, 50)
ANGLE = st.floats(-10, 10)


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [(0.0, 0.0), (math.pi, math.pi), (-math.pi, math.pi), (1.5 * math.pi, -0.5 * math.pi), (-7.0, -7.0 + 2 * math.pi)],
)
def test_wrapped_angles_lie_above_minus_pi_up_to_pi(angle, wrapped):
    assert wrap(angle) == pytest.approx(wrapped)


@given(ANGLE)
def test_wrapping_keeps_the_direction(angle):
    assert -math.pi < wrap(angle) <= math.pi
    assert math.cos(wrap(angle) - angle) == pytest.approx(1.0)


def test_forward_is_where_the_robot_looks_and_left_is_counter_clockwise_of_it():
    north = Pose(2.0, 3.0, 0.5 * math.pi)
    assert to_world(north, 4.0, 1.0) == pytest.approx((1.0, 7.0))
    assert to_robot(north, 2.0, 7.0) == pytest.approx((4.0, 0.0))


@given(PLACE, PLACE, ANGLE, PLACE, PLACE)
def test_the_two_frames_are_inverse(x, y, theta, forward, left):
    pose = Pose(x, y, theta)
    assert to_robot(pose, *to_world(pose, forward, left)) == pytest.approx((forward, left), abs=1e-9)
