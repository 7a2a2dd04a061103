"""Path following at cruise speed with limited yaw rate and without inertia: an exactly integrated unicycle."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

_LOOKAHEAD_M = 0.3
"""Distance ahead on the path at which the vehicle aims: short, so that it cuts corners by only a few centimetres."""
_SPIN_RAD = 0.6
"""Heading error above which the vehicle turns on the spot."""


@njit(cache=True, error_model="numpy")
def advance(x: float, y: float, theta: float, v: float, omega: float, dt: float) -> tuple[float, float, float]:
    """Compute the pose after `dt` (s) at constant forward speed (m/s) and yaw rate (rad/s): an arc of a circle."""
    if abs(omega) < 1e-9:
        return x + v * dt * math.cos(theta), y + v * dt * math.sin(theta), theta + omega * dt
    end = theta + omega * dt
    return x + v / omega * (math.sin(end) - math.sin(theta)), y - v / omega * (math.cos(end) - math.cos(theta)), end


@njit(cache=True, error_model="numpy")
def follow(
    start: tuple[float, float, float],
    path: NDArray[np.float64],
    speed: float,
    yaw_rate: float,
    dt: float,
    most: int,
    commands: NDArray[np.float64],
    poses: NDArray[np.float64],
) -> int:
    """Drive along a path, Shape=(N, 2), points (m) a few centimetres apart, to its end. Return the number of ticks.

    It is `most` if the end was not reached. `commands`, Shape=(>= most, 2), and `poses`, Shape=(>= most, 3), are
    written: forward speed and yaw rate of each tick, and the pose after it.
    """
    x, y, theta = start
    last = path.shape[0] - 1
    aim = 0  # never goes back: a vehicle in a hairpin would turn to and fro between both legs
    for k in range(most):
        while aim < last and math.hypot(path[aim, 0] - x, path[aim, 1] - y) < _LOOKAHEAD_M:
            aim += 1
        dx, dy = path[aim, 0] - x, path[aim, 1] - y
        left = math.hypot(dx, dy)
        if aim == last and left < 0.05:
            return k
        error = math.atan2(dy, dx) - theta
        error = math.atan2(math.sin(error), math.cos(error))
        omega = min(max(error / dt, -yaw_rate), yaw_rate)
        v = speed * max(0.0, 1.0 - abs(error) / _SPIN_RAD)
        if aim == last:
            v = min(v, left / dt)
        x, y, theta = advance(x, y, theta, v, omega, dt)
        commands[k, 0], commands[k, 1] = v, omega
        poses[k, 0], poses[k, 1], poses[k, 2] = x, y, theta
    return most
