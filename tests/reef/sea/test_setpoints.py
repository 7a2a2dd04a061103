"""Joystick axes and climb rates against numbers by hand."""

import math

import pytest

from coral.reef.sea.setpoints import NEUTRAL, StickLoop, climb_rate


def test_without_measurements_the_axes_are_the_feed_forward():
    assert StickLoop().axes(0.5, 0.15, (None, None), 0.1) == (500, 0, 500, -200)


def test_slow_turns_get_past_the_dead_zone():
    assert StickLoop().axes(0.0, 0.03, (None, None), 0.1)[3] == -120
    assert StickLoop().axes(0.0, -0.03, (None, None), 0.1)[3] == 120


def test_no_command_is_neutral():
    assert StickLoop().axes(0.0, 0.0, (None, None), 0.1) == NEUTRAL


def test_the_loop_pushes_harder_while_the_vehicle_is_too_slow():
    loop = StickLoop()
    first = loop.axes(0.5, 0.0, (0.3, 0.0), 0.1)[0]
    assert first == 500 + 80 + 4
    assert loop.axes(0.5, 0.0, (0.3, 0.0), 0.1)[0] == first + 4


def test_the_integral_is_bounded_and_ends_with_the_command():
    loop = StickLoop()
    for _ in range(1000):
        loop.axes(0.6, 0.0, (0.0, 0.0), 0.1)
    assert loop.integral == 500.0
    loop.axes(0.0, 0.0, (0.0, 0.0), 0.1)
    assert loop.integral == 0.0


@pytest.mark.parametrize(("speed", "turn"), [(9.0, 9.0), (-9.0, -9.0)])
def test_axes_keep_to_their_range(speed, turn):
    x, _, z, r = StickLoop().axes(speed, turn, (None, None), 0.1)
    assert abs(x) == abs(r) == 1000
    assert z == 500


@pytest.mark.parametrize(
    ("depth", "rate"), [(0.0, 0.25), (1.9, 0.08), (2.0, 0.0), (2.1, -0.08), (9.0, -0.25), (None, 0.0), (math.nan, 0.0)]
)
def test_climb_rate_goes_to_the_depth_within_its_limit(depth, rate):
    assert climb_rate(depth, 2.0) == pytest.approx(rate)


def test_a_wanted_depth_that_is_no_number_changes_nothing():
    assert climb_rate(1.0, math.nan) == 0.0
