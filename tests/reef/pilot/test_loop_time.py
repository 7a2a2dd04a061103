"""Time for the pilot."""

import math

import pytest

from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.pilot.loop_time import LoopTime


def follow(*clock):
    """Times of the pilot, and the ticks at which the clock was not believed."""
    time, told, jumps = LoopTime(gap_s=1.0), [], []
    for k, now in enumerate(clock):
        try:
            time.advance(now)
        except UnfitMeasurement as fault:
            jumps.append((k, fault.reason))
        told.append(time.t)
    return told, jumps


def test_a_clock_that_advances_is_followed_exactly():
    clock = [round(0.1 * k, 9) for k in range(50)]
    assert follow(*clock) == (clock, [])


@pytest.mark.parametrize("by", [-30.0, 30.0])
def test_over_a_jump_time_goes_on_by_one_period(by):
    told, jumps = follow(5.0, 5.2, 5.4 + by, 5.6 + by, 5.8)
    assert told == pytest.approx([5.0, 5.2, 5.4, 5.6, 5.8])
    assert jumps == [(2, "jumped"), (4, "jumped")]


def test_a_clock_that_stands_still_does_not_stop_time():
    told, jumps = follow(0.0, 0.1, 0.1, 0.1, 0.2)
    assert told == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])
    assert [k for k, _ in jumps] == [2, 3]


@pytest.mark.parametrize(("bad", "reason"), [(math.nan, "not finite"), ("x", "wrong type"), (1e300, "no time")])
def test_a_clock_that_tells_no_time_does_not_stop_it(bad, reason):
    told, jumps = follow(7.0, 7.1, bad, 7.3)
    assert told == pytest.approx([7.0, 7.1, 7.2, 7.3])
    assert jumps == [(2, reason)]


def test_time_never_runs_backwards_even_from_a_bad_start():
    told, _ = follow(math.nan, math.nan, -50.0, 1e300, -50.0, -49.9)
    assert told == sorted(told)
