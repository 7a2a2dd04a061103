"""What `coral reef sail` looks at before arming: its sensors for a while, and those that are not there yet."""

from __future__ import annotations

import time
from typing import Any

from coral.commands.sail_parts import Parts
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.sea.checklist import CheckLine, Equipment, StampRates, blocking, preflight_list
from coral.reef.sea.safety import SafetyCfg

LOOK_S = 2.0
"""The checks before arming watch the sensors for this long, to measure their rates."""
PATIENCE_S = 30.0
"""Longest wait for sensors that are not there yet."""
AWAITED = "vehicle", "pose", "velocity", "depth", "camera", "sonar"


def watch_sensors(parts: Parts, area: Any, safety: SafetyCfg, equipment: Equipment, sonar: SonarCfg) -> list[CheckLine]:
    """Watch the sensors for a while and make the preflight list; wait for those that are not there yet."""
    rates, began = StampRates(), time.monotonic()

    def measured() -> bool:
        known = (rates.rate_hz("pose"), parts.camera.rate_hz, 0.0 if parts.sonar is None else parts.sonar.rate_hz)
        return None not in known

    while True:
        looked = time.monotonic()
        while (spent := time.monotonic() - looked) < LOOK_S or (spent < 3.0 * LOOK_S and not measured()):
            rates.note(time.monotonic(), parts.link.report())
            parts.place()
            time.sleep(0.02)
        now, report = time.monotonic(), parts.link.report()
        lines = preflight_list(now, report, rates, parts.camera, area, safety, equipment, parts.sonar, sonar)
        waits = [line for line in blocking(lines) if line.subject in AWAITED]
        if not waits or now - began > PATIENCE_S:
            return lines
