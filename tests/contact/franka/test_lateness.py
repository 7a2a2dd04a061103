"""Percentiles from bins."""

import pytest

from coral.contact.franka.lateness import Lateness


def test_the_percentile_is_rounded_up_to_a_bin():
    lateness = Lateness()
    for _ in range(99):
        lateness.add(0.00105)
    lateness.add(0.05)
    assert lateness.percentile_ms(0.99) == pytest.approx(1.1)
    assert lateness.max_ms == pytest.approx(50.0)


def test_without_ticks_nothing_was_late_and_an_early_tick_is_on_time():
    lateness = Lateness()
    assert lateness.percentile_ms(0.99) == 0.0
    lateness.add(-0.003)
    assert lateness.max_ms == 0.0
