"""The line in one process: time goes on by reading; faults on command."""

import numpy as np

from autopilot.autopilot import SimulatedAutopilot
from autopilot.body import Body, OpenWater
from autopilot.line import AutopilotLine


def line():
    return AutopilotLine(SimulatedAutopilot(Body(OpenWater())), np.random.default_rng(1))


def listen(line, seconds):
    return [data for _ in range(round(seconds / 0.05)) if (data := line.receive(0.05))]


def test_a_cut_line_is_silent_while_the_vehicle_goes_on():
    one = line()
    one.cut = True
    assert listen(one, 5.0) == []
    assert abs(one.autopilot.time_s - 5.0) < 1e-9


def test_delay_keeps_datagrams_back():
    one = line()
    one.delay_s = 3.0
    assert listen(one, 2.9) == []
    assert len(listen(one, 5.0)) >= 4


def test_garbled_datagrams_differ_in_one_bit():
    one, other = line(), line()
    other.garble = 1.0
    for right, wrong in zip(listen(one, 5.0), listen(other, 5.0), strict=True):
        assert sum((a ^ b).bit_count() for a, b in zip(right, wrong, strict=True)) == 1
