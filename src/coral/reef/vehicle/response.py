"""How a vehicle follows its set-points: a delay, a fast lag, and a part of the velocity that trails behind."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

from coral.config import Fraction, NonNegative, Positive
from coral.reef.vehicle.vehicle import VehicleCfg, VehicleState

STEP_S = 0.02
"""Longest step of a prediction."""


class Trailing(NamedTuple):
    """The part of the velocity that follows slowly, in the world frame (m/s)."""

    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, kw_only=True)
class VehicleResponse:
    """How speed and yaw rate follow what is asked for: the file of `coral reef sail --response`.

    A share `trail` of the wanted velocity is followed slowly, in a frame that does not turn with the vehicle; the rest
    at once, but for a lag: body velocity' = ((1 - trail) wanted + trailing - velocity) / lag, and
    trailing' = (trail wanted - trailing) / trail_lag. So a vehicle whose autopilot integrates the error of a velocity
    in north and east coasts on after a stop, and along the old course in a turn.
    """

    surge_gain: Positive = 1.0
    """Speed reached, as a share of the speed asked for."""
    surge_lag_s: Positive = 0.25
    surge_delay_s: NonNegative = 0.0
    """From a set-point until the speed begins to change."""
    trail: Fraction = 0.0
    """0: all of the velocity turns and stops with the vehicle, as with our own velocity loop."""
    trail_lag_s: Positive = 2.0
    yaw_gain: Positive = 1.0
    yaw_lag_s: Positive = 0.25
    yaw_delay_s: NonNegative = 0.0
    margin_m: NonNegative = 0.0
    """Clearance kept besides the controller's own: the error of positions predicted by this model."""

    @classmethod
    def of_vehicle(cls, cfg: VehicleCfg) -> VehicleResponse:
        """Return the response of the simulated vehicle."""
        return cls(surge_lag_s=1.0 / cfg.tracking_rate_1_s, yaw_lag_s=1.0 / cfg.yaw_tracking_rate_1_s)

    @property
    def delay_s(self) -> float:
        """The longer delay."""
        return max(self.surge_delay_s, self.yaw_delay_s)

    def setpoint(self, forward_m_s: float, yaw_rate_rad_s: float) -> tuple[float, float]:
        """Return what to ask the vehicle for, so that it reaches a speed (m/s) and a yaw rate (rad/s)."""
        return forward_m_s / self.surge_gain, yaw_rate_rad_s / self.yaw_gain

    def advance(
        self, state: VehicleState, trailing: Trailing, command: tuple[float, float], dt: float
    ) -> tuple[VehicleState, Trailing]:
        """Move a state on by `dt` (s) under a speed (m/s) and a yaw rate (rad/s) that already act."""
        n = max(1, math.ceil(dt / STEP_S - 1e-9))
        h = dt / n
        surge, yaw = -math.expm1(-h / self.surge_lag_s), -math.expm1(-h / self.yaw_lag_s)
        slow = -math.expm1(-h / self.trail_lag_s)
        x, y, theta, u, v, r = state
        wx, wy = trailing
        for _ in range(n):
            c, s = math.cos(theta), math.sin(theta)
            u1 = u + surge * ((1.0 - self.trail) * command[0] + c * wx + s * wy - u)
            v1 = v + surge * (c * wy - s * wx - v)
            r1 = r + yaw * (command[1] - r)
            wx += slow * (self.trail * command[0] * c - wx)
            wy += slow * (self.trail * command[0] * s - wy)
            turn = 0.5 * h * (r + r1)
            c, s = math.cos(theta + 0.5 * turn), math.sin(theta + 0.5 * turn)
            um, vm = 0.5 * (u + u1), 0.5 * (v + v1)
            x, y, theta = x + h * (c * um - s * vm), y + h * (s * um + c * vm), theta + turn
            u, v, r = u1, v1, r1
        return VehicleState(x, y, theta, u, v, r), Trailing(wx, wy)


class DelayedCommands:
    """Remembers the commands that are under way, to know the state in which the next one will find the vehicle."""

    def __init__(self, response: VehicleResponse, period_s: float) -> None:
        """Set up for commands that are given every `period_s` (s)."""
        self.response, self.period_s = response, period_s
        under_way = math.ceil(response.delay_s / period_s - 1e-9) + 1
        self._sent: deque[tuple[float, float]] = deque([(0.0, 0.0)] * under_way, maxlen=under_way)
        self._fast = 0.0
        """Forward speed that follows at once, by the model (m/s)."""

    def note(self, command: tuple[float, float]) -> None:
        """Remember what has just been sent, as wanted speeds (m/s, rad/s)."""
        self._sent.append(command)
        response = self.response
        acting = _at(list(self._sent), -response.surge_delay_s - self.period_s, self.period_s)[0]
        share = -math.expm1(-self.period_s / response.surge_lag_s)
        self._fast += share * ((1.0 - response.trail) * acting - self._fast)

    def trailing(self, state: VehicleState, most_m_s: float = 1.0) -> Trailing:
        """Return what trails behind: the measured velocity without the part that follows at once (m/s).

        No more can trail than the share of the largest forward speed that is asked for (m/s).
        """
        if self.response.trail == 0.0:
            return Trailing()
        u, v = state.u - self._fast, state.v
        size = math.hypot(u, v)
        scale = min(1.0, self.response.trail * most_m_s / size) if size > 0.0 else 0.0
        c, s = math.cos(state.theta), math.sin(state.theta)
        return Trailing(scale * (c * u - s * v), scale * (s * u + c * v))

    def predict(self, state: VehicleState, trailing: Trailing) -> tuple[VehicleState, Trailing]:
        """Return the state at the time when a command that is given now begins to act."""
        ahead, sent, period = self.response.delay_s, list(self._sent), self.period_s
        t = 0.0
        while t < ahead - 1e-9:
            step = min(period, ahead - t)
            surge = _at(sent, t - self.response.surge_delay_s, period)[0]
            yaw = _at(sent, t - self.response.yaw_delay_s, period)[1]
            state, trailing = self.response.advance(state, trailing, (surge, yaw), step)
            t += step
        return state, trailing


def _at(sent: list[tuple[float, float]], t: float, period_s: float) -> tuple[float, float]:
    """Return the command in force `t` (s, not positive) from now; the last one was given one period ago."""
    back = max(1, math.ceil(-t / period_s - 1e-9))
    return sent[-min(back, len(sent))]
