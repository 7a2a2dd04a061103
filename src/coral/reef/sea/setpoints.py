"""Set-points as ArduSub takes them: velocities in GUIDED, joystick axes in ALT_HOLD."""

from __future__ import annotations

import math
from dataclasses import dataclass

VELOCITY_AND_YAW_RATE = 0b0101_1100_0111
"""Type mask of SET_POSITION_TARGET_LOCAL_NED: position, acceleration and yaw ignored. ArduSub drops a velocity whose
acceleration bits are not all set (also after its changes to GUIDED in 2026, which concern positions)."""
NEUTRAL = (0, 0, 500, 0)
"""Axes x, y, z, r of MANUAL_CONTROL that mean: do nothing."""


X_PER_M_S, R_PER_RAD_S = 1000.0, 667.0
"""Feed-forwards, measured with ArduSub 4.7.0-dev and its simulated BlueROV2 Heavy at the default joystick gain of 0.5:
x = 500 gives 0.5 m/s; r = 145 gives 0.06 rad/s and r = 200 gives 0.15 rad/s, past a dead zone of 100."""
R_DEAD = 100.0
"""Axis units about the middle that turn nothing."""
SPEED_P, SPEED_I, YAW_P = 400.0, 200.0, 300.0
"""Axis units per m/s of error, per m of it (the integral is limited to half an axis), and per rad/s."""
DEPTH_GAIN_1_S, DEPTH_SPEED_M_S = 0.8, 0.25
"""Vertical speed per metre of depth error, and its limit."""
FRESH_S = 0.5
"""Older measurements are not used: then the axis is the feed-forward alone."""


@dataclass
class StickLoop:
    """Velocity and yaw rate to the axes of MANUAL_CONTROL: feed-forward, and PI on what is measured.

    ALT_HOLD keeps depth and heading itself when the axes are neutral.
    """

    integral: float = 0.0

    def axes(
        self, forward_m_s: float, yaw_rate_rad_s: float, measured: tuple[float | None, float | None], dt: float
    ) -> tuple[int, int, int, int]:
        """Return x, y, z, r (-1000 to 1000; z from 0, neutral 500) for one period of `dt` seconds.

        A positive yaw rate is to the left. Of the measured speed and yaw rate, what is not fresh is None.
        """
        x, turning = X_PER_M_S * forward_m_s, R_PER_RAD_S * yaw_rate_rad_s
        speed, turn = measured
        if forward_m_s == 0.0:
            self.integral = 0.0
        if speed is not None:
            error = forward_m_s - speed
            if forward_m_s != 0.0:
                self.integral = min(max(self.integral + SPEED_I * error * dt, -500.0), 500.0)
            x += SPEED_P * error + self.integral
        if turn is not None:
            turning += YAW_P * (yaw_rate_rad_s - turn)
        if yaw_rate_rad_s == 0.0:
            return _axis(x), 0, 500, 0  # the autopilot holds the heading itself
        return _axis(x), 0, 500, _axis(-turning - math.copysign(R_DEAD, turning))


def _axis(value: float) -> int:
    return round(min(max(value, -1000.0), 1000.0))


def climb_rate(depth_m: float | None, wanted_m: float) -> float:
    """Return the downward speed (m/s) that brings the vehicle to a depth; 0 where one of them is no number."""
    if depth_m is None or not math.isfinite(depth_m) or not math.isfinite(wanted_m):
        return 0.0
    return min(max(DEPTH_GAIN_1_S * (wanted_m - depth_m), -DEPTH_SPEED_M_S), DEPTH_SPEED_M_S)
