"""What ArduSub calls its modes and versions, where its messages come from, and its set-points in GUIDED."""

from __future__ import annotations

import importlib
import math
from typing import Any

from coral.errors import InputError, install_extra

MODES = {
    0: "STABILIZE",
    1: "ACRO",
    2: "ALT_HOLD",
    3: "AUTO",
    4: "GUIDED",
    7: "CIRCLE",
    9: "SURFACE",
    16: "POSHOLD",
    19: "MANUAL",
    20: "MOTOR_DETECT",
    21: "SURFTRAK",
}
NUMBERS = {name: number for number, name in MODES.items()}
SUBMARINE = 12
"""MAV_TYPE_SUBMARINE."""
ARDUPILOT = 3
"""MAV_AUTOPILOT_ARDUPILOTMEGA."""
MAKERS = {ARDUPILOT: "ArduPilot", 12: "PX4"}
AUTOPILOT_COMPONENT = 1
ARMED_BIT = 128
DOWN = 25
"""MAV_SENSOR_ROTATION_PITCH_270: a range finder that looks down."""
EKF_POSITION = 8 | 16
"""EKF_STATUS_REPORT flags of a horizontal position, relative or absolute."""
EKF_CONST_POSITION = 128
"""The filter pretends to stand still, for want of measurements."""
VELOCITY_AND_YAW_RATE = 0b0101_1100_0111
"""Type mask of SET_POSITION_TARGET_LOCAL_NED: position, acceleration and yaw ignored. ArduSub drops a velocity whose
acceleration bits are not all set (also after its changes to GUIDED in 2026, which concern positions)."""
NEUTRAL = (0, 0, 500, 0)
"""Axes x, y, z, r of MANUAL_CONTROL that mean: do nothing."""
DEPTH_GAIN_1_S, DEPTH_SPEED_M_S = 0.8, 0.25
"""Vertical speed per metre of depth error, and its limit."""
OLDEST, TESTED = (4, 1, 0), (4, 7, 0)
"""GUIDED takes body velocities with a yaw rate from 4.1 on; the driver was tried with 4.7.0-dev."""


def load_dialect(where: str = "--vehicle") -> Any:
    """Import MAVLink's messages; `where` is what needs them, for the error.

    Raises:
        InputError: pymavlink is not installed.
    """
    try:
        return importlib.import_module("pymavlink.dialects.v20.ardupilotmega")
    except ModuleNotFoundError:
        raise InputError(where, "", "no pymavlink", install_extra("vehicle")) from None


def version_of(number: int) -> tuple[int, int, int]:
    """Read AUTOPILOT_VERSION.flight_sw_version: major, minor, patch."""
    return number >> 24 & 255, number >> 16 & 255, number >> 8 & 255


def maker_name(number: int) -> str:
    """Name a MAV_AUTOPILOT."""
    return MAKERS.get(number, f"number {number}")


def version_text(number: int, git: bytes, maker: int = ARDUPILOT, kind_of_vehicle: int = SUBMARINE) -> str:
    """Describe a version: "ArduSub 4.7.0-dev (507e6101)"; another vehicle's autopilot by its maker's name."""
    kind = number & 255
    stage = "" if kind == 255 else "-rc" if kind >= 192 else "-beta" if kind >= 128 else "-dev"
    text = "".join(chr(c) for c in git if 48 <= c < 123)
    name = "ArduSub" if (maker, kind_of_vehicle) == (ARDUPILOT, SUBMARINE) else maker_name(maker)
    return f"{name} {'.'.join(map(str, version_of(number)))}{stage}" + (f" ({text})" if text else "")


def version_warning(number: int) -> str:
    """Say what a version is not known to do; "" if nothing."""
    version = version_of(number)
    shown = ".".join(map(str, version))
    if version < OLDEST:
        return f"ArduSub {shown} is older than 4.1: GUIDED may not take velocities"
    if version[:2] > TESTED[:2]:
        return f"ArduSub {shown} is newer than 4.7, which the driver was tried with: rehearse GUIDED first"
    return ""


def has_position(flags: int) -> bool:
    """Check whether the estimator's flags promise a horizontal position."""
    return bool(flags & EKF_POSITION) and not flags & EKF_CONST_POSITION


def range_down(message: Any) -> float | None:
    """Return the distance to the floor (m) in a DISTANCE_SENSOR; None if it looks elsewhere, or is out of range."""
    valid = message.min_distance <= message.current_distance <= message.max_distance
    return 0.01 * float(message.current_distance) if valid and message.orientation == DOWN else None


def climb_rate(depth_m: float | None, wanted_m: float) -> float:
    """Return the downward speed (m/s) that brings the vehicle to a depth; 0 where one of them is no number."""
    if depth_m is None or not math.isfinite(depth_m) or not math.isfinite(wanted_m):
        return 0.0
    return min(max(DEPTH_GAIN_1_S * (wanted_m - depth_m), -DEPTH_SPEED_M_S), DEPTH_SPEED_M_S)
