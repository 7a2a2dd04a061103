"""When the simulated autopilot acts by itself: ArduSub's failsafes as functions of time and parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from autopilot.parameters import BATTERY_ACTIONS, GCS_ACTIONS, ParameterStore

Action = Literal["", "disarm", "surface", "hold"]


@dataclass
class Circumstances:
    """What the failsafes watch. Times are the autopilot's own (s)."""

    gcs_heard_s: float = -math.inf
    pilot_heard_s: float = -math.inf
    leak_until_s: float = -math.inf
    volts: float = 12.6
    armed: bool = False


@dataclass
class Verdict:
    """One failsafe that fired."""

    action: Action
    severity: int
    text: str


class Failsafes:
    """Fires each failsafe once, until its cause is gone."""

    def __init__(self) -> None:
        self.lost_gcs = self.lost_pilot = self.leaking = self.low = False
        self._low_since_s = math.inf
        self._leak_told_s = -math.inf

    def check(self, now: float, seen: Circumstances, parameters: ParameterStore) -> list[Verdict]:
        """Return what fires at `now` (s)."""
        return [
            *self._gcs(now, seen, parameters),
            *self._pilot(now, seen, parameters),
            *self._leak(now, seen, parameters),
            *self._battery(now, seen, parameters),
        ]

    def _gcs(self, now: float, seen: Circumstances, parameters: ParameterStore) -> list[Verdict]:
        enabled = parameters["FS_GCS_ENABLE"]
        if not enabled or seen.gcs_heard_s == -math.inf:
            return []
        if now - seen.gcs_heard_s < parameters["FS_GCS_TIMEOUT"]:
            cleared, self.lost_gcs = self.lost_gcs, False
            return [Verdict("", 6, "GCS Failsafe Cleared")] if cleared else []
        if self.lost_gcs or not seen.armed:
            return []
        self.lost_gcs = True
        return [Verdict(_action(GCS_ACTIONS, enabled), 4, "MYGCS: heartbeat lost")]

    def _pilot(self, now: float, seen: Circumstances, parameters: ParameterStore) -> list[Verdict]:
        enabled = parameters["FS_PILOT_INPUT"]
        if not enabled or now - seen.pilot_heard_s < parameters["FS_PILOT_TIMEOUT"]:
            self.lost_pilot = False
            return []
        if self.lost_pilot:
            return []
        self.lost_pilot = True
        return [Verdict("disarm" if enabled == 2 else "", 2, "Lost manual control")]

    def _leak(self, now: float, seen: Circumstances, parameters: ParameterStore) -> list[Verdict]:
        enabled = parameters["FS_LEAK_ENABLE"]
        if not enabled or now > seen.leak_until_s:
            self.leaking = False
            return []
        told = now - self._leak_told_s > 20.0
        if told:
            self._leak_told_s = now
        first, self.leaking = not self.leaking, True
        surface = first and enabled == 2 and seen.armed
        if not (told or surface):
            return []
        return [Verdict("surface" if surface else "", 2, "Leak Detected" if told else "")]

    def _battery(self, now: float, seen: Circumstances, parameters: ParameterStore) -> list[Verdict]:
        limit = parameters["BATT_LOW_VOLT"]
        if limit <= 0.0 or seen.volts >= limit:
            self._low_since_s = math.inf
            return []
        self._low_since_s = min(self._low_since_s, now)
        if self.low or not seen.armed or now - self._low_since_s < parameters["BATT_LOW_TIMER"]:
            return []
        self.low = True
        text = f"Battery 1 is low {seen.volts:.2f}V used 0 mAh"
        return [Verdict(_action(BATTERY_ACTIONS, parameters["BATT_FS_LOW_ACT"]), 4, text)]


def _action(table: dict[int, str], value: float) -> Action:
    return table.get(int(value), "")  # type: ignore[return-value]
