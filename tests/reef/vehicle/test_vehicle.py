import dataclasses
import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleDynamics, VehicleState
from coral.reef.world.geometry import Pose


def drive(cfg, command, seconds=6.0, current=(0.0, 0.0), **keys):
    vehicle = VehicleDynamics(cfg, VehicleState(0.0, 0.0, 0.0))
    for _ in range(round(seconds / 0.1)):
        vehicle.step(command, current=current, **keys)
    return vehicle


@pytest.mark.parametrize("command", [(0.6, 0.0), (0.3, 0.6), (0.0, -0.6), (-0.2, 0.2)])
def test_velocity_loop_reaches_its_set_point(command):
    s = drive(VehicleCfg(), command).state
    assert (s.u, s.v, s.r) == pytest.approx((command[0], 0.0, command[1]), abs=1e-3)


def test_commands_are_limited():
    s = drive(VehicleCfg(), (2.0, -3.0)).state
    assert (s.u, s.r) == pytest.approx((0.6, -0.6), abs=1e-3)


def test_unknown_model_is_named():
    with pytest.raises(InputError, match="planar or kinematic"):
        VehicleDynamics(VehicleCfg(model="submarine"))  # type: ignore[arg-type]


def test_acceleration_follows_from_the_thrusters():
    weak = dataclasses.replace(VehicleCfg(), thrust_max_n=5.0)
    s = drive(weak, (0.6, 0.0), seconds=20.0).state
    # 4 cos45 5 N = 14.14 N = 13.7 u + 141 u^2
    assert s.u == pytest.approx(0.272, abs=1e-3)


def test_a_current_is_held_off():
    s = drive(VehicleCfg(), (0.0, 0.0), seconds=20.0, current=(0.1, -0.1)).state
    assert math.hypot(s.u, s.v) < 1e-3
    assert math.hypot(s.x, s.y) < 0.1
    s = drive(VehicleCfg(), (0.5, 0.3), seconds=20.0, current=(0.1, 0.0)).state
    assert (s.u, s.v) == pytest.approx((0.5, 0.0), abs=0.02)


def test_stops_within_twenty_centimetres():
    vehicle = drive(VehicleCfg(), (0.6, 0.0))
    before = vehicle.state.x
    for _ in range(30):
        vehicle.step((0.0, 0.0))
    assert 0.05 < vehicle.state.x - before < 0.2


def test_every_substep_is_returned():
    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(1.0, 2.0, 0.0))
    trace = vehicle.step((0.6, 0.0))
    assert trace.shape == (5, 2)
    assert trace[-1] == pytest.approx(vehicle.state[:2])
    assert vehicle.step((0.6, 0.0), dt=1.0).shape == (50, 2)
    fine = VehicleDynamics(VehicleCfg(substep_s=0.005))
    assert fine.step((0.6, 0.0)).shape == (20, 2)


def test_the_default_step_is_converged():
    """Half and quarter of the default integration step move the end of a ten second drive by under 0.1 mm."""
    ends = []
    for substep in (0.02, 0.01, 0.0025):
        vehicle = VehicleDynamics(VehicleCfg(substep_s=substep))
        for i in range(100):
            vehicle.step((0.5, 0.5 * math.sin(0.1 * i)), current=(0.05, 0.1))
        ends.append(np.array(vehicle.state))
    assert np.abs(ends[0] - ends[2])[:2].max() < 1e-4
    assert np.abs(ends[1] - ends[2])[:2].max() < 1e-5


def test_contact_stops_the_hull_at_the_surface_and_lets_it_slide():
    def wall(x, y):
        return 1.0 - x

    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(0.0, 0.0, 0.5))
    for _ in range(60):
        vehicle.step((0.4, 0.0), contact=wall)
        assert vehicle.state.x <= 0.7 + 1e-9
    assert vehicle.state.x == pytest.approx(0.7, abs=1e-3)
    assert vehicle.state.y > 0.5


def test_trace_shows_the_penetration_that_contact_removes():
    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(0.69, 0.0, 0.0, 0.5, 0.0, 0.0))
    trace = vehicle.step((0.5, 0.0), contact=lambda x, y: 1.0 - x)
    assert trace[:, 0].max() > 0.7


def test_heading_wraps():
    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(0.0, 0.0, 3.1))
    for _ in range(20):
        vehicle.step((0.0, 0.6))
        assert -math.pi < vehicle.state.theta <= math.pi
    assert vehicle.state.theta < 0.0


def test_a_bare_pose_is_a_state_at_rest_and_reset_forgets():
    vehicle = VehicleDynamics(VehicleCfg(), Pose(1.0, 2.0, 0.5))
    assert vehicle.state == (1.0, 2.0, 0.5, 0.0, 0.0, 0.0)
    first = [tuple(vehicle.step((0.4, 0.1), current=(0.1, 0.0))[-1]) for _ in range(5)]
    vehicle.reset(Pose(1.0, 2.0, 0.5))
    assert [tuple(vehicle.step((0.4, 0.1), current=(0.1, 0.0))[-1]) for _ in range(5)] == first


@pytest.mark.parametrize("substep_s", [0.02, 0.008])
def test_an_obstacle_that_is_near_but_not_met_changes_nothing(substep_s):
    cfg = VehicleCfg(substep_s=substep_s)
    alone, beside = VehicleDynamics(cfg), VehicleDynamics(cfg)
    rng = np.random.default_rng(4)
    for _ in range(50):
        command, current = rng.uniform(-0.8, 0.8, 2), rng.uniform(-0.1, 0.1, 2)
        track = alone.step(tuple(command), current=tuple(current))
        assert np.array_equal(beside.step(tuple(command), current=tuple(current), contact=lambda x, y: 0.301), track)
        assert beside.state == alone.state
        assert np.array_equal(beside._s, alone._s)  # the thrusters, too


def test_an_obstacle_met_within_a_tick_stops_the_hull():
    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(0.0, 0.0, 0.0, u=0.6))
    wall = 0.33
    track = vehicle.step((0.6, 0.0), contact=lambda x, y: wall - x)
    assert track[:, 0].max() > wall - 0.3
    assert vehicle.state.x <= wall - 0.3 + 1e-9
    assert vehicle.state.u < 0.05
