"""The equations of motion against hand values, invariants and a plain NumPy twin."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coral.reef.vehicle.dynamics import (
    THRUST_MAX_N,
    Thrusters,
    planar,
    thrust_n,
)
from coral.reef.vehicle.dynamics_kernels import (
    limit_wrench,
    planar_acceleration,
    planar_rk4,
)

A = planar(Thrusters())
settings.register_profile("kernels", deadline=None)  # the first call compiles
settings.load_profile("kernels")
speeds = st.floats(-1.0, 1.0)
STILL = np.zeros(2)


def numpy_acceleration(nu, tau):
    """Twin of `planar_acceleration` with the full 3x3 matrices of Fossen's book."""
    (u, v, _), mass = nu, np.diag([A.m11, A.m22, A.m66])
    coriolis = np.array([[0, 0, -A.m22 * v], [0, 0, A.m11 * u], [A.m22 * v, -A.m11 * u, 0]])
    drag = np.diag(np.array([A.du, A.dv, A.dr]) + np.array([A.duu, A.dvv, A.drr]) * np.abs(nu))
    return np.linalg.solve(mass, tau - coriolis @ nu - drag @ nu)


@given(st.lists(speeds, min_size=3, max_size=3), st.lists(st.floats(-50, 50), min_size=3, max_size=3))
def test_the_model_matches_the_matrix_form(nu, tau):
    assert planar_acceleration(*nu, *tau, A) == pytest.approx(numpy_acceleration(np.array(nu), np.array(tau)), abs=1e-9)


def test_planar_masses_match_hand_values():
    assert (A.m11, A.m22, A.m66) == pytest.approx((19.86, 20.62, 0.592))


def test_steady_speed_at_full_thrust():
    """Hand values: the root of d u + dd u^2 = 4 cos45 30.4 N."""
    fx, fy, _ = limit_wrench(1e9, 0.0, 0.0, A)[0], limit_wrench(0.0, 1e9, 0.0, A)[1], 0.0
    assert (fx, fy) == pytest.approx((85.98, 85.98), abs=0.01)
    for i, force, expected in ((3, (fx, 0.0, 0.0), 0.734), (4, (0.0, fy, 0.0), 0.629)):
        s = np.zeros(9)
        for _ in range(3000):
            planar_rk4(s, np.array(force), STILL, 0.0287, 0.01, A)
        assert s[i] == pytest.approx(expected, abs=0.001)


def test_static_thrust_curve():
    assert pytest.approx(30.4, abs=1e-9) == THRUST_MAX_N
    assert np.all(np.diff(thrust_n(np.linspace(-0.97, 0.97, 500))) > 0)


@given(st.floats(-300, 300), st.floats(-300, 300), st.floats(-80, 80))
def test_limited_wrench_is_within_every_thruster(fx, fy, n):
    limited = limit_wrench(fx, fy, n, A)
    surge, sway, yaw = limited[0] / A.force_arm, limited[1] / A.force_arm, limited[2] / A.moment_arm
    forces = np.array([surge - sway - yaw, surge + sway + yaw, surge + sway - yaw, surge - sway + yaw])
    assert np.abs(forces).max() <= A.thrust_max + 1e-9
    # and those four forces, at 45 degrees, make that wrench
    geometry = [(0.156, 0.111, -1), (0.156, -0.111, 1), (-0.156, 0.111, 1), (-0.156, -0.111, -1)]
    c = math.sqrt(0.5)
    made = np.zeros(3)
    for (x, y, side), f in zip(geometry, forces, strict=True):
        made += f * np.array([c, side * c, x * side * c - y * c])
    assert made == pytest.approx(limited, abs=1e-9)


def test_yaw_is_served_before_surge():
    fx, _, n = limit_wrench(1e6, 0.0, 12.0, A)
    assert n == pytest.approx(12.0)
    assert 0.0 < fx < 86.0


def kinetic_energy(s):
    return 0.5 * (A.m11 * s[3] ** 2 + A.m22 * s[4] ** 2 + A.m66 * s[5] ** 2)


def test_energy_lost_without_thrust_is_the_work_of_drag():
    s = np.array([0, 0, 0, 0.6, 0.3, 0.8, 0, 0, 0], dtype=float)
    before, work, h = kinetic_energy(s), 0.0, 1e-3
    for _ in range(2000):
        u, v, r = s[3:6]
        power = (A.du + A.duu * abs(u)) * u**2 + (A.dv + A.dvv * abs(v)) * v**2 + (A.dr + A.drr * abs(r)) * r**2
        last = kinetic_energy(s)
        planar_rk4(s, np.zeros(3), STILL, 0.0287, h, A)
        assert kinetic_energy(s) < last
        u, v, r = s[3:6]
        after = (A.du + A.duu * abs(u)) * u**2 + (A.dv + A.dvv * abs(v)) * v**2 + (A.dr + A.drr * abs(r)) * r**2
        work += 0.5 * h * (power + after)
    assert before - kinetic_energy(s) == pytest.approx(work, rel=1e-5)


def turn_and_go(h, seconds=2.0):
    s = np.array([0, 0, 0, 0.1, 0.05, 0.1, 0, 0, 0], dtype=float)
    for _ in range(round(seconds / h)):
        planar_rk4(s, np.array([60.0, 5.0, 0.6]), np.array([0.1, -0.05]), 0.0287, h, A)
    return s


def test_integration_converges_with_the_order_of_rk4_and_is_converged_at_the_default_step():
    truth = turn_and_go(0.000625)
    error = [np.abs(turn_and_go(h) - truth).max() for h in (0.02, 0.01, 0.005)]
    assert error[0] / error[1] > 12.0
    assert error[1] / error[2] > 12.0
    assert np.abs(turn_and_go(0.02) - truth)[:2].max() < 1e-4  # metres, at the default step


def test_a_passive_vehicle_drifts_with_the_current():
    s = np.zeros(9)
    s[3:5] = -0.1, 0.05  # at rest over ground
    water = np.array([0.1, -0.05])
    for _ in range(200):
        planar_rk4(s, np.zeros(3), water, 0.0287, 0.02, A)
    start = s.copy()
    for _ in range(30000):
        planar_rk4(s, np.zeros(3), water, 0.0287, 0.02, A)
    c, si = math.cos(s[2]), math.sin(s[2])
    ground = np.array([c * s[3] - si * s[4], si * s[3] + c * s[4]]) + water
    assert ground == pytest.approx(water, abs=2e-3)
    assert np.hypot(*(s[:2] - start[:2])) > 50.0
