"""Fossen's equations of motion for the BlueROV2: surge, sway and yaw, RK4 (numba).

Velocities in this file are relative to the water. In a steady irrotational current Fossen's
M nu' + C(nu) nu + D(nu) nu = tau holds for the relative velocity (added mass and drag both act on it), so only the
position equation needs the current.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from coral.reef.vehicle.dynamics import Planar

Array = NDArray[np.float64]


@njit(cache=True, error_model="numpy")
def clip(value: float, limit: float) -> float:
    """Clip a value to [-limit, limit]."""
    return min(max(value, -limit), limit)


@njit(cache=True, error_model="numpy")
def limit_wrench(fx: float, fy: float, n: float, model: Planar) -> tuple[float, float, float]:
    """Limit a wrench (N, N, N m) to what the four horizontal thrusters can produce.

    Yaw has priority, then sway, then surge with the thrust that is left: a vehicle that cannot hold its heading cannot
    avoid anything.
    """
    n1 = clip(n / model.moment_arm, model.thrust_max)
    left = model.thrust_max - abs(n1)
    fy1 = clip(fy / model.force_arm, left)
    fx1 = clip(fx / model.force_arm, left - abs(fy1))
    return fx1 * model.force_arm, fy1 * model.force_arm, n1 * model.moment_arm


@njit(cache=True)
def tracking_wrench(
    u: float, v: float, r: float, v_cmd: float, omega_cmd: float, rate: float, yaw_rate: float, model: Planar
) -> tuple[float, float, float]:
    """Compute the unlimited wrench (N, N, N m) of the velocity loop: surge to v_cmd, sway to 0, yaw rate to omega_cmd.

    Feedback linearisation: drag and Coriolis terms of the model are fed forward, and the error decays at `rate` (1/s)
    in surge and sway and at `yaw_rate` (1/s) in yaw.
    """
    fx = model.m11 * rate * (v_cmd - u) + (model.du + model.duu * abs(u)) * u - model.m22 * v * r
    fy = -model.m22 * rate * v + (model.dv + model.dvv * abs(v)) * v + model.m11 * u * r
    n = model.m66 * yaw_rate * (omega_cmd - r) + (model.dr + model.drr * abs(r)) * r + (model.m22 - model.m11) * u * v
    return fx, fy, n


@njit(cache=True)
def planar_acceleration(
    u: float, v: float, r: float, fx: float, fy: float, n: float, model: Planar
) -> tuple[float, float, float]:
    """Compute the planar acceleration (m/s^2, m/s^2, rad/s^2) from water-relative velocities and the wrench."""
    du = (fx + model.m22 * v * r - (model.du + model.duu * abs(u)) * u) / model.m11
    dv = (fy - model.m11 * u * r - (model.dv + model.dvv * abs(v)) * v) / model.m22
    dr = (n - (model.m22 - model.m11) * u * v - (model.dr + model.drr * abs(r)) * r) / model.m66
    return du, dv, dr


@njit(cache=True)
def _planar_rate(s: Array, asked: Array, current: Array, lag_s: float, model: Planar, out: Array) -> None:
    c, si = math.cos(s[2]), math.sin(s[2])
    out[0] = c * s[3] - si * s[4] + current[0]
    out[1] = si * s[3] + c * s[4] + current[1]
    out[2] = s[5]
    out[3], out[4], out[5] = planar_acceleration(s[3], s[4], s[5], s[6], s[7], s[8], model)
    for i in range(3):
        out[6 + i] = (asked[i] - s[6 + i]) / lag_s


@njit(cache=True)
def planar_rk4(s: Array, asked: Array, current: Array, lag_s: float, h: float, model: Planar) -> None:
    """Advance the planar model by one RK4 step, in place.

    Args:
        s: Shape=(9,), x, y, theta, water-relative u, v, r, and the present wrench (Fx, Fy, N).
        asked: Shape=(3,), commanded wrench, within the thrusters' limits, constant over the step.
        current: Shape=(2,), water velocity in the world (m/s).
        lag_s: Time constant of the thrust (s). All thrusters share it, so the wrench has the same lag.
        h: Step (s).
        model: Constants of the vehicle.
    """
    k1, k2, k3, k4 = np.empty(9), np.empty(9), np.empty(9), np.empty(9)
    _planar_rate(s, asked, current, lag_s, model, k1)
    _planar_rate(s + 0.5 * h * k1, asked, current, lag_s, model, k2)
    _planar_rate(s + 0.5 * h * k2, asked, current, lag_s, model, k3)
    _planar_rate(s + h * k3, asked, current, lag_s, model, k4)
    s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@njit(cache=True)
def planar_step(s: Array, asked: Array, current: Array, lag_s: float, h: float, model: Planar) -> None:
    """Run `planar_rk4` on ground-relative velocities and wrap the heading to (-pi, pi]; s as in `planar_drive`."""
    c, si = math.cos(s[2]), math.sin(s[2])
    s[3] -= c * current[0] + si * current[1]
    s[4] -= -si * current[0] + c * current[1]
    planar_rk4(s, asked, current, lag_s, h, model)
    c, si = math.cos(s[2]), math.sin(s[2])
    s[2] = math.pi - (math.pi - s[2]) % (2 * math.pi)
    s[3] += c * current[0] + si * current[1]
    s[4] += -si * current[0] + c * current[1]


@njit(cache=True)
def planar_drive(
    s: Array,
    memory: Array,
    v_cmd: float,
    omega_cmd: float,
    rate: float,
    yaw_rate: float,
    period: float,
    gain: float,
    model: Planar,
    current: Array,
    lag_s: float,
    h: float,
    trace: Array,
) -> None:
    """Run one period of the velocity loop, and the motion in it, without obstacles.

    The loop's estimated disturbance moves towards the part of the last period's motion that the model does not explain.

    Args:
        s: Shape=(9,), x, y, theta, ground-relative u, v, r, and the present wrench. Updated in place.
        memory: Shape=(9,), disturbance in the world frame (N, N, N m), then velocity and wrench one period ago, NaN
            if there was none. Updated in place.
        v_cmd: Surge set point (m/s).
        omega_cmd: Yaw-rate set point (rad/s).
        rate: As in `tracking_wrench`.
        yaw_rate: As in `tracking_wrench`.
        period: Period of the loop (s).
        gain: Share of the disturbance's error that one period corrects.
        model: Constants of the vehicle.
        current: Shape=(2,), water velocity in the world (m/s).
        lag_s: Time constant of the thrust (s).
        h: Integration step (s).
        trace: Shape=(steps, 2), written: positions after every integration step.
    """
    c, si = math.cos(s[2]), math.sin(s[2])
    if not np.isnan(memory[3]):
        mean, force = 0.5 * (memory[3:6] + s[3:6]), 0.5 * (memory[6:9] + s[6:9])
        du, dv, dr = planar_acceleration(mean[0], mean[1], mean[2], force[0], force[1], force[2], model)
        extra_u = model.m11 * ((s[3] - memory[3]) / period - du)
        extra_v = model.m22 * ((s[4] - memory[4]) / period - dv)
        extra_r = model.m66 * ((s[5] - memory[5]) / period - dr)
        memory[0] += gain * (c * extra_u - si * extra_v - memory[0])
        memory[1] += gain * (si * extra_u + c * extra_v - memory[1])
        memory[2] += gain * (extra_r - memory[2])
    fx, fy, n = tracking_wrench(s[3], s[4], s[5], v_cmd, omega_cmd, rate, yaw_rate, model)
    dx, dy, dn = memory[0], memory[1], memory[2]
    asked = np.array(limit_wrench(fx - c * dx - si * dy, fy + si * dx - c * dy, n - dn, model))
    memory[3:6] = s[3:6]
    memory[6:9] = s[6:9]
    for j in range(trace.shape[0]):
        planar_step(s, asked, current, lag_s, h, model)
        trace[j, 0], trace[j, 1] = s[0], s[1]
