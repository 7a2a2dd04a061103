"""Failsafes: when each fires, that it fires once, and what it does."""

import math

import pytest

from autopilot.failsafes import Circumstances, Failsafes
from autopilot.parameters import ParameterStore


def fired(seen, parameters, until=40.0, step=0.5):
    failsafes, found = Failsafes(), []
    for k in range(round(until / step) + 1):
        found += [(k * step, v.action, v.text) for v in failsafes.check(k * step, seen, ParameterStore(parameters))]
    return found


@pytest.mark.parametrize(("enabled", "action"), [(2.0, "disarm"), (3.0, "hold"), (4.0, "surface"), (1.0, "")])
def test_five_seconds_after_the_last_heartbeat(enabled, action):
    seen = Circumstances(gcs_heard_s=1.0, armed=True)
    assert fired(seen, {"FS_GCS_ENABLE": enabled}) == [(6.0, action, "MYGCS: heartbeat lost")]


@pytest.mark.parametrize("seen", [Circumstances(armed=True), Circumstances(gcs_heard_s=1.0)])
def test_no_ground_station_ever_or_no_motors_is_no_loss(seen):
    assert fired(seen, {}) == []


def test_a_ground_station_that_comes_back_is_told():
    failsafes, seen = Failsafes(), Circumstances(gcs_heard_s=0.0, armed=True)
    assert failsafes.check(6.0, seen, ParameterStore())[0].action == "disarm"
    seen.gcs_heard_s = 7.0
    assert failsafes.check(7.0, seen, ParameterStore())[0].text == "GCS Failsafe Cleared"
    assert failsafes.check(7.5, seen, ParameterStore()) == []


@pytest.mark.parametrize(("enabled", "action"), [(2.0, "disarm"), (1.0, "")])
def test_a_pilot_that_falls_silent(enabled, action):
    seen = Circumstances(pilot_heard_s=1.0, armed=True)
    assert fired(seen, {"FS_PILOT_INPUT": enabled}) == [(4.0, action, "Lost manual control")]


def test_a_leak_surfaces_once_and_is_told_every_twenty_seconds():
    seen = Circumstances(leak_until_s=math.inf, armed=True)
    found = fired(seen, {"FS_LEAK_ENABLE": 2.0}, until=41.0)
    assert found == [(0.0, "surface", "Leak Detected"), (20.5, "", "Leak Detected"), (41.0, "", "Leak Detected")]


def test_a_leak_only_warns_by_default_and_never_moves_a_disarmed_vehicle():
    assert fired(Circumstances(leak_until_s=1.0, armed=True), {}) == [(0.0, "", "Leak Detected")]
    assert fired(Circumstances(leak_until_s=1.0), {"FS_LEAK_ENABLE": 2.0}) == [(0.0, "", "Leak Detected")]


@pytest.mark.parametrize(("act", "action"), [(3.0, "surface"), (2.0, "disarm"), (0.0, "")])
def test_a_low_battery_acts_after_its_timer(act, action):
    seen = Circumstances(volts=11.0, armed=True)
    parameters = {"BATT_LOW_VOLT": 12.0, "BATT_LOW_TIMER": 2.0, "BATT_FS_LOW_ACT": act}
    assert fired(seen, parameters) == [(2.0, action, "Battery 1 is low 11.00V used 0 mAh")]


def test_a_battery_that_recovers_in_time_does_not():
    failsafes, seen = Failsafes(), Circumstances(volts=11.0, armed=True)
    parameters = ParameterStore({"BATT_LOW_VOLT": 12.0, "BATT_LOW_TIMER": 2.0})
    assert failsafes.check(0.0, seen, parameters) == []
    seen.volts = 12.5
    assert failsafes.check(1.9, seen, parameters) == []
    seen.volts = 11.0
    assert failsafes.check(2.5, seen, parameters) == []
