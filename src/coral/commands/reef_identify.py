"""`coral reef identify`: measure how a vehicle follows its set-points, for the controller of `coral reef sail`."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coral.commands.keyboard import Keyboard
from coral.commands.sail_conduct import beside_keyboard
from coral.commands.sail_parts import await_truth
from coral.config import Positive, checked, to_mapping
from coral.errors import InputError, RunError
from coral.file_writer import write_whole
from coral.reef.sea.operator import OperatorWords
from coral.reef.sea.response_trial import Leg, TrialLog, drive, identify, legs
from coral.reef.sea.transport import parse_address
from coral.reef.vehicle.response import VehicleResponse
from coral.terminal import tell
from coral.yaml_file import to_yaml

POSITION_S = 120.0
"""Longest wait for a position."""
SETTLE_S = 10.0
"""Time that the vehicle has to reach its depth."""


@dataclass(frozen=True, kw_only=True)
class ReefIdentify:
    """Measure how a vehicle follows set-points: it drives steps of speed and yaw rate for two minutes, within 5 m.

    The result is a file for `coral reef sail --response FILE`. The vehicle is armed only when the operator types arm.
    """

    vehicle: str
    """mavlink:udp:HOST:PORT and so on, as for `coral reef sail`."""
    out: Path = Path("response.yaml")
    """The file to write; an existing one is not overwritten."""
    speed: Positive = 0.5
    """Forward speed of the steps (m/s)."""
    yaw_rate: Positive = 0.5
    """Yaw rate of the steps (rad/s)."""
    depth: Positive = 1.0
    """Depth to hold (m)."""
    truth: str = ""
    """Second address of a simulation in the loop, which proves to be one."""
    yes: bool = False
    """Arm without asking; only for a simulation that proves to be one."""
    json: bool = False
    """Print one JSON object on standard output; everything else goes to standard error."""

    def __call__(self) -> Mapping[str, Any]:
        from coral.reef.sea.mavlink_link import MavlinkLink

        checked(self, "flags")
        if self.out.exists():
            raise InputError("--out", "", str(self.out), "a file that does not exist yet")
        with ExitStack() as opened:
            link = MavlinkLink(parse_address(self.vehicle))
            opened.callback(link.close)
            if self.truth:
                await_truth(self.truth, opened)
            elif self.yes:
                raise InputError("--yes", "", f"{self.vehicle}, which may be a real vehicle", "--truth of a simulation")
            log = self._drive(link)
        response, surge, yaw = identify(log)
        write_whole(self.out, to_yaml(to_mapping(response)))
        errors = {"surge_error_m_s": round(surge.error, 4), "yaw_error_rad_s": round(yaw.error, 4)}
        return {**to_mapping(response), **errors, "file": str(self.out)}

    def _drive(self, link: Any) -> TrialLog:
        began = time.monotonic()
        while not link.report().has_position:
            if time.monotonic() - began > POSITION_S:
                raise RunError("the autopilot has no position: a response cannot be measured without one")
            time.sleep(0.2)
        words = OperatorWords()
        if not self.yes:
            tell("the vehicle will drive within 5 m of where it is. Type arm and press Enter to let it")
            if not Keyboard(words).wait_for_arm():
                raise RunError("not armed: the operator did not say so")
        link.arm()

        def stopped() -> str:
            return "".join(f"stopped by the operator ({word})" for word, _ in words.take()[:1])

        plan = (Leg(0.0, 0.0, SETTLE_S), *legs(self.speed, self.yaw_rate))
        tell("driving; space stops it")
        try:
            return beside_keyboard(lambda: drive(link, plan, self.depth, time.monotonic, time.sleep, stopped), words)
        finally:
            link.hold()

    def describe(self, result: Mapping[str, Any]) -> str:
        found = VehicleResponse(**{name: result[name] for name in to_mapping(VehicleResponse())})
        return (
            f"speed: {found.surge_gain:.0%} of what is asked, lag {found.surge_lag_s:.2f} s after "
            f"{found.surge_delay_s:.2f} s\n"
            f"turn: {found.yaw_gain:.0%} of what is asked, lag {found.yaw_lag_s:.2f} s after "
            f"{found.yaw_delay_s:.2f} s\n"
            f"{found.trail:.0%} of the speed trails behind, with a lag of {found.trail_lag_s:.1f} s\n"
            f"positions predicted 1 s ahead err by up to {found.margin_m:.2f} m (95 %): the margin\n"
            f"written to {result['file']}"
        )
