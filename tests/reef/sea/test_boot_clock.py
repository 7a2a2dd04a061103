"""The autopilot's clock, seen through a line with delays, restarts and jumps."""

import pytest

from coral.reef.sea.boot_clock import BootClock


def clock_with(messages):
    clock = BootClock()
    return clock, [clock.stamp(boot, now) for boot, now in messages]


def test_the_fastest_message_sets_the_offset_and_late_ones_get_old_stamps():
    _, stamps = clock_with([(1.0, 11.05), (1.1, 11.11), (1.2, 11.7)])
    assert stamps == pytest.approx([11.05, 11.11, 11.21])


def test_no_stamp_is_later_than_now():
    clock = BootClock()
    clock.stamp(1.0, 11.0)
    assert clock.stamp(1.5, 11.2) == 11.2


def test_a_restart_is_believed_at_the_third_message_from_the_past():
    clock, stamps = clock_with([(100.0, 200.0), (0.1, 203.0), (0.2, 203.1), (0.3, 203.2), (0.4, 203.3)])
    assert stamps == [200.0, None, None, 203.2, pytest.approx(203.3)]
    assert clock.reboots == 1
    assert clock.jumps == 0


def test_one_late_packet_is_no_restart():
    clock, stamps = clock_with([(100.0, 200.0), (100.1, 200.1), (98.0, 200.2), (100.2, 200.2), (98.1, 200.3)])
    assert stamps[2] is None
    assert stamps[3] == pytest.approx(200.2)
    assert clock.reboots == 0


def test_a_jump_forward_is_counted_and_stamps_are_right_again():
    clock, stamps = clock_with([(10.0, 20.0), (15.1, 20.1), (15.2, 20.2)])
    assert clock.jumps == 1
    assert clock.reboots == 0
    assert stamps[1:] == pytest.approx([20.1, 20.2])


def test_a_slower_clock_is_followed():
    """A simulation at nine tenths of real time: without a window the last stamp would be 6 s old."""
    clock = BootClock()
    for k in range(600):
        stamp = clock.stamp(0.09 * k, 0.1 * k)
    assert 0.0 <= 59.9 - stamp <= 1.1


def test_a_fast_time_reply_replaces_what_was_learnt():
    clock = BootClock()
    clock.stamp(1.0, 11.0)
    clock.synchronise(12.00, 1.5, 12.02)
    assert clock.offset_s == pytest.approx(10.51)
    clock.synchronise(13.0, 1.0, 13.5)
    assert clock.offset_s == pytest.approx(10.51)


def test_after_a_silence_the_old_offset_is_forgotten():
    clock = BootClock()
    clock.stamp(1.0, 11.0)
    assert clock.stamp(2.0, 62.0) == 62.0
