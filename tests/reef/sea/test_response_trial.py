"""The calibration drive, with the simulated autopilot in its own time."""

import dataclasses

import numpy as np
import pytest
from sea_vehicles import SimulatedVehicle

from coral.errors import RunError
from coral.reef.sea.response_trial import (
    Leg,
    TrialLog,
    drive,
    fit_step_response,
    identify,
    lagged,
    legs,
    prediction_errors,
)

AT = np.arange(0.0, 40.0, 0.1)
COMMAND = np.where((AT > 2) & (AT < 10), 0.5, np.where((AT > 20) & (AT < 28), 0.3, 0.0))
T = np.arange(0.0, 40.0, 0.05)


@pytest.fixture(scope="module")
def vehicle():
    vehicle = SimulatedVehicle()
    vehicle.run(3.0)
    vehicle.link.arm()
    return vehicle


def sail(vehicle, plan, stopped=lambda: ""):
    return drive(vehicle.link, plan, 1.0, vehicle.now, vehicle.run, stopped)


def test_the_drive_returns_near_to_where_it_began():
    plan = legs(0.5, 0.5)
    assert sum(leg.seconds for leg in plan) < 150.0
    assert {np.sign(leg.yaw_rate_rad_s) for leg in plan} == {-1.0, 0.0, 1.0}
    assert {np.sign(leg.forward_m_s) for leg in plan} == {-1.0, 0.0, 1.0}


def test_the_simulated_autopilot_is_identified(vehicle):
    """It reaches 85 % of the speed behind a lag of 0.5 s and the velocity loop's 0.25 s."""
    log = sail(vehicle, legs(0.5, 0.5))
    response, surge, _ = identify(log)
    assert response.surge_gain == pytest.approx(0.85, abs=0.03)
    assert response.yaw_gain == pytest.approx(1.0, abs=0.03)
    total = response.surge_delay_s + (1 - response.trail) * response.surge_lag_s + response.trail * response.trail_lag_s
    assert total == pytest.approx(0.75, abs=0.2)
    assert surge.error < 0.03
    assert 0.0 < response.margin_m < 0.15
    wrong = dataclasses.replace(response, surge_gain=1.0, surge_lag_s=0.05, trail=0.0, surge_delay_s=0.0)
    assert np.mean(prediction_errors(wrong, log)) > 1.5 * np.mean(prediction_errors(response, log))


def test_the_operator_ends_the_drive(vehicle):
    with pytest.raises(RunError, match="ended early: enough"):
        sail(vehicle, (Leg(0.2, 0.0, 5.0),), lambda: "enough")


def test_a_person_at_the_controls_ends_the_drive(vehicle):
    vehicle.autopilot.choose("MANUAL")
    vehicle.run(2.0)
    with pytest.raises(RunError, match="taken over"):
        sail(vehicle, (Leg(0.2, 0.0, 5.0),))


def test_too_little_is_no_identification():
    with pytest.raises(RunError, match="0 new velocities"):
        identify(TrialLog())


def test_a_lagged_step_in_closed_form():
    y = lagged(np.array([0.5, 1.5]), np.array([0.0]), np.array([2.0]), 0.5, 1.0)
    assert y == pytest.approx([0.0, 2.0 * (1 - np.exp(-1))])


def test_a_single_lag_is_found():
    rng = np.random.default_rng(0)
    y = 0.85 * lagged(T, AT, COMMAND, 0.4, 0.2) + rng.normal(0.0, 0.01, len(T))
    found = fit_step_response(T, y, AT, COMMAND, trails=False)
    assert found.gain == pytest.approx(0.85, abs=0.01)
    assert (found.lag_s, found.delay_s) == (pytest.approx(0.4, abs=0.05), pytest.approx(0.2, abs=0.05))
    assert found.error == pytest.approx(0.01, rel=0.2)


def test_a_trailing_share_is_found():
    y = 0.64 * lagged(T, AT, COMMAND, 0.1, 0.1) + 0.16 * lagged(T, AT, COMMAND, 4.0, 0.1)
    found = fit_step_response(T, y, AT, COMMAND, trails=True)
    assert found.gain == pytest.approx(0.8, abs=0.01)
    assert (found.trail, found.trail_lag_s) == (pytest.approx(0.2, abs=0.02), 4.0)


def test_a_vehicle_that_stands_is_told():
    with pytest.raises(RunError, match="did not follow its set-points"):
        fit_step_response(T, np.zeros_like(T), AT, COMMAND, trails=True)
