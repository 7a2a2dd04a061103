"""The parameters of the simulated autopilot, under ArduSub's names and with its defaults."""

from __future__ import annotations

import math
from collections.abc import Mapping

DEFAULTS: dict[str, float] = {
    "BATT_ARM_VOLT": 0.0,
    "BATT_FS_LOW_ACT": 0.0,
    "BATT_LOW_TIMER": 10.0,
    "BATT_LOW_VOLT": 0.0,
    "FS_GCS_ENABLE": 2.0,
    "FS_GCS_TIMEOUT": 5.0,
    "FS_LEAK_ENABLE": 1.0,
    "FS_PILOT_INPUT": 0.0,
    "FS_PILOT_TIMEOUT": 3.0,
    "JS_GAIN_DEFAULT": 0.5,
    "MAV_GCS_SYSID": 255.0,
    "PILOT_SPEED_UP": 100.0,
    "SIM_BATT_VOLTAGE": 12.6,
    "SIM_GPS1_ENABLE": 1.0,
    "WPNAV_SPEED": 100.0,
}
"""As read from ArduSub 4.7.0-dev, except FS_PILOT_INPUT: there it is 2, but simulated builds leave its check out."""
BATTERY_ACTIONS = {2: "disarm", 3: "surface"}
"""BATT_FS_LOW_ACT. 0 and 1 only tell."""
GCS_ACTIONS = {2: "disarm", 3: "hold", 4: "surface"}
"""FS_GCS_ENABLE."""


class ParameterStore:
    """Parameters by name. Values survive a restart, as in the autopilot's memory."""

    def __init__(self, changes: Mapping[str, float] | None = None) -> None:
        self.values = {**DEFAULTS, **(changes or {})}
        self.names = sorted(self.values)

    def __getitem__(self, name: str) -> float:
        return self.values[name]

    def write(self, name: str, value: float) -> bool:
        """Set a known parameter. Return whether it was."""
        if name not in self.values or not math.isfinite(value):
            return False
        self.values[name] = value
        return True
