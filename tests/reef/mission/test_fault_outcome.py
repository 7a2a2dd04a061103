"""What a vehicle did about a fault."""

import pytest

from coral.reef.mission.fault_outcome import outcome_of
from coral.reef.simulation.faults import SensorFault

FAULT = SensorFault("blind-camera", 1.0, 2.0)
HELD = [
    {"t": 0.0, "event": "state", "state": "surveying", "reason": "sensors good"},
    {"t": 1.0, "event": "sensor", "input": "camera", "refused": "blind"},
    {"t": 1.5, "event": "state", "state": "holding", "reason": "camera blind, for 0.5 s"},
    {"t": 4.0, "event": "state", "state": "surveying", "reason": "sensors back"},
]


def rows(*speeds):
    """One row per tick of 0.1 s, along x."""
    x, made = 0.0, []
    for k, speed in enumerate(speeds):
        x += 0.1 * speed
        made.append({"t": f"{0.1 * (k + 1):.1f}", "x": str(x), "y": "0.0", "u": str(speed), "v": "0.0"})
    return made


def test_a_vehicle_that_is_held_and_goes_on():
    found = outcome_of(FAULT, HELD, rows(*[0.5] * 15, 0.3, 0.1, 0.01, *[0.0] * 30))
    assert found.said == "camera blind, for 0.5 s"
    assert (found.held_after_s, found.back_after_s) == (0.5, 1.0)
    assert found.stopped_after_s == pytest.approx(0.8)
    assert found.driven_m == pytest.approx(0.1 * (5 * 0.5 + 0.3 + 0.1 + 0.01), abs=1e-3)
    assert found.collisions == 0


def test_one_that_drives_on_is_measured_until_the_end_of_the_fault():
    found = outcome_of(FAULT, [*HELD[:2], {"t": 2.0, "event": "collision"}], rows(*[0.5] * 50))
    assert found.said == "camera blind"
    assert (found.held_after_s, found.stopped_after_s, found.back_after_s) == (None, None, None)
    assert found.driven_m == pytest.approx(1.0)
    assert found.collisions == 1


def test_a_fault_that_nobody_noticed_says_nothing():
    assert outcome_of(FAULT, HELD[:1], rows(*[0.5] * 50)).said == ""


def test_a_vehicle_that_stood_before_it_was_held_is_not_counted_as_stopped_early():
    found = outcome_of(FAULT, HELD, rows(*[0.0] * 50))
    assert found.stopped_after_s == pytest.approx(0.6)
