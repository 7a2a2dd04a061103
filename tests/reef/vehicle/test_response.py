"""How a vehicle follows its set-points: lags in closed form, what trails behind, commands under way."""

import math

import pytest

from coral.reef.vehicle.response import DelayedCommands, Trailing, VehicleResponse
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleState

STANDING = VehicleState(0.0, 0.0, 0.0)


def test_a_step_of_the_speed_is_an_exponential():
    response = VehicleResponse(surge_lag_s=0.5)
    state, _ = response.advance(STANDING, Trailing(), (0.4, 0.0), 0.5)
    assert state.u == pytest.approx(0.4 * (1 - math.exp(-1)), abs=1e-9)
    assert state.x == pytest.approx(0.4 * 0.5 * math.exp(-1), abs=1e-3)


def test_what_trails_carries_a_vehicle_on_after_a_stop():
    """Without trailing it stands after 5 lags; with it, its share decays with the long lag."""
    at_once, trails = VehicleResponse(surge_lag_s=0.1), VehicleResponse(surge_lag_s=0.1, trail=0.2, trail_lag_s=4.0)
    moving = VehicleState(0.0, 0.0, 0.0, 0.4)
    short, _ = at_once.advance(moving, Trailing(), (0.0, 0.0), 2.0)
    long, rest = trails.advance(moving, Trailing(0.08, 0.0), (0.0, 0.0), 2.0)
    assert short.x == pytest.approx(0.04, abs=0.005)
    assert long.x == pytest.approx(0.04 + 0.08 * 4.0 * (1 - math.exp(-0.5)), abs=0.02)
    assert rest.x == pytest.approx(0.08 * math.exp(-0.5), rel=1e-6)


def test_what_trails_keeps_the_old_course_while_the_vehicle_turns():
    response = VehicleResponse(surge_lag_s=0.1, trail=0.2, trail_lag_s=1e6)
    east = VehicleState(0.0, 0.0, math.pi / 2, 0.0, 0.0, 0.0)
    state, _ = response.advance(east, Trailing(0.1, 0.0), (0.0, 0.0), 2.0)
    assert (state.u, state.v) == (pytest.approx(0.0, abs=1e-6), pytest.approx(-0.1, abs=1e-6))
    assert state.x > 0.15


def test_the_response_of_the_simulated_vehicle_is_its_velocity_loop():
    response = VehicleResponse.of_vehicle(VehicleCfg(tracking_rate_1_s=2.0, yaw_tracking_rate_1_s=5.0))
    assert (response.surge_lag_s, response.yaw_lag_s, response.delay_s, response.trail) == (0.5, 0.2, 0.0, 0.0)


def test_a_setpoint_makes_up_for_the_gain():
    assert VehicleResponse(surge_gain=0.8, yaw_gain=0.5).setpoint(0.4, 0.1) == (pytest.approx(0.5), pytest.approx(0.2))


def test_without_delay_the_present_state_is_the_prediction():
    under_way = DelayedCommands(VehicleResponse(), 0.1)
    under_way.note((0.5, 0.3))
    assert under_way.predict(VehicleState(1.0, 2.0, 0.5, 0.3), Trailing())[0] == VehicleState(1.0, 2.0, 0.5, 0.3)


def test_commands_under_way_move_the_prediction():
    response = VehicleResponse(surge_delay_s=0.2, yaw_delay_s=0.2, surge_lag_s=0.1, yaw_lag_s=0.1)
    under_way = DelayedCommands(response, 0.1)
    assert under_way.predict(STANDING, Trailing())[0] == STANDING
    under_way.note((0.5, 0.0))
    under_way.note((0.0, 0.4))
    expected = response.advance(STANDING, Trailing(), (0.5, 0.0), 0.1)
    expected = response.advance(*expected, (0.0, 0.4), 0.1)
    assert under_way.predict(STANDING, Trailing())[0] == pytest.approx(expected[0])


def test_trailing_is_the_velocity_that_the_last_commands_do_not_explain():
    response = VehicleResponse(surge_lag_s=0.1, trail=0.25)
    under_way = DelayedCommands(response, 0.1)
    for _ in range(30):
        under_way.note((0.4, 0.0))
    cruising = VehicleState(0.0, 0.0, math.pi / 2, 0.4)
    assert under_way.trailing(cruising) == pytest.approx((0.0, 0.1), abs=1e-6)
    assert under_way.trailing(cruising._replace(u=5.0), most_m_s=0.6) == pytest.approx((0.0, 0.15), abs=1e-6)


def test_nothing_trails_where_the_response_says_so():
    assert DelayedCommands(VehicleResponse(), 0.1).trailing(VehicleState(0.0, 0.0, 0.0, 0.5)) == (0.0, 0.0)
