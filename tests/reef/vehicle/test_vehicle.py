import dataclasses
import math

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


def test_contact_stops_the_hull_at_the_surface_and_lets_it_slide():
    def wall(x, y):
        return 1.0 - x

    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(0.0, 0.0, 0.5))
    for _ in range(60):
        vehicle.step((0.4, 0.0), contact=wall)
        assert vehicle.state.x <= 0.7 + 1e-9
    assert vehicle.state.x == pytest.approx(0.7, abs=1e-3)
    assert vehicle.state.y > 0.5


def test_a_bare_pose_is_a_state_at_rest_and_reset_forgets():
    vehicle = VehicleDynamics(VehicleCfg(), Pose(1.0, 2.0, 0.5))
    assert vehicle.state == (1.0, 2.0, 0.5, 0.0, 0.0, 0.0)
    first = [tuple(vehicle.step((0.4, 0.1), current=(0.1, 0.0))[-1]) for _ in range(5)]
    vehicle.reset(Pose(1.0, 2.0, 0.5))
    assert [tuple(vehicle.step((0.4, 0.1), current=(0.1, 0.0))[-1]) for _ in range(5)] == first


def test_an_obstacle_met_within_a_tick_stops_the_hull():
    vehicle = VehicleDynamics(VehicleCfg(), VehicleState(0.0, 0.0, 0.0, u=0.6))
    wall = 0.33
    track = vehicle.step((0.6, 0.0), contact=lambda x, y: wall - x)
    assert track[:, 0].max() > wall - 0.3
    assert vehicle.state.x <= wall - 0.3 + 1e-9
    assert vehicle.state.u < 0.05
