"""What a survey in real water needs besides a mission: its limits, and what happens when one is reached."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from coral.config import Fraction, NonNegative, Positive
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.sea.link import VehicleReport
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.world.geometry import Pose

Action = Literal["none", "hold", "return", "surface"]
"""none: only reported. hold: the autopilot keeps the vehicle where it is. return: back to the start, around what is on
the map, and then as `after_return` says. surface: the autopilot brings it up."""
FLOOR_S = 0.7
"""A DVL A50 sends at least twice a second; ArduSub forgets a range after another 0.5 s."""
GRAVITY: dict[str, int] = {"none": 0, "hold": 1, "return": 2, "surface": 3}


@dataclass(frozen=True, kw_only=True)
class SafetyCfg:
    """Limits, and the action for each."""

    link_timeout_s: Positive = 0.7
    """Without any news from the vehicle for this long, the link counts as lost. Its state comes ten times a second."""
    heartbeat_timeout_s: Positive = 3.5
    """Heartbeats come once a second; three may be missed."""
    on_link_lost: Action = "hold"
    """No order reaches a vehicle without a link: the order is repeated, and the autopilot's own failsafes act."""
    pose_timeout_s: Positive = 0.7
    """A position older than this is no position."""
    on_pose_lost: Action = "hold"
    """The position is old or lost."""
    on_floor_lost: Action = "none"
    """The range to the floor came, and is silent. Where it is a DVL's (`RNGFND1_TYPE` 10), a silent DVL shows here
    first: ArduSub continues by dead reckoning, and keeps its position for 7 s."""
    on_clock_jump: Action = "hold"
    """The clock of the autopilot jumped."""
    on_reboot: Action = "hold"
    """After a restart the autopilot's position has another origin: the survey does not continue by itself."""
    on_fence: Action = "hold"
    """Outside the geofence or inside a keep-out. The planner keeps away from both; this is the second line."""
    on_leak: Action = "surface"
    """Water inside the hull."""
    battery_min: Fraction = 0.25
    """Share of the charge at which the survey ends."""
    battery_min_v: NonNegative = 0.0
    """The same in volts; 0 for no such limit. 14.0 suits the four cells in series of a BlueROV2."""
    on_battery: Action = "return"
    """Either limit of the battery."""
    tether_turns: Positive = 5.0
    """Turns of the tether, either way."""
    on_tether: Action = "hold"
    """More turns than that."""
    return_speed_m_s: Positive = 0.3
    """Speed over ground assumed for the way back: half of what is driven."""
    reserve_s: NonNegative = 30.0
    """Time kept back for the way home, besides the way itself."""
    on_time: Action = "return"
    """When the time left, by the time limit or by the battery's decline, is only just enough for the way back."""
    on_done: Action = "hold"
    """What follows when nothing is left to explore."""
    after_return: Literal["hold", "surface"] = "hold"
    """What the vehicle does once it is back."""
    on_unjudged: Action = "none"
    """The eyes judge nothing: what they see is unlike all that they have learned, or too murky. With none the survey
    goes on by the sonar, if there is one, and the map says that nothing was judged."""
    unjudged_s: Positive = 20.0
    """For this long."""
    settle_s: Positive = 2.0
    """A lost link or position must be back for this long before the survey continues."""


@dataclass(frozen=True, kw_only=True)
class SailCfg:
    """What a survey in real time needs besides a mission's configuration."""

    mission: MissionCfg = field(default_factory=MissionCfg)
    safety: SafetyCfg = field(default_factory=SafetyCfg)
    depth_m: Positive = 1.0
    """Depth to hold."""
    response: VehicleResponse | None = None
    """How the vehicle follows its set-points; None: as the simulated one does."""


@dataclass(frozen=True)
class Breach:
    """A limit that has been reached."""

    cause: str
    """link, pose, floor, clock, reboot, eyes, fence, leak, battery, tether or time."""
    reason: str
    """In words, with the numbers."""
    action: Action
    passing: bool = False
    """Whether the survey continues by itself when the cause is gone."""


@dataclass
class SafetyMonitor:
    """Checks every report of the vehicle against the limits."""

    cfg: SafetyCfg
    area: SurveyArea
    time_limit_s: float
    reboots: int = 0
    """Restarts of the autopilot that the operator knows of: those before the survey."""
    clock_jumps: int = 0
    sees_m: Callable[[], float] = lambda: math.inf
    """How far the eyes tell oysters from sea floor (m)."""
    _saw_s: float = 0.0
    _full: tuple[float, float] | None = None
    """When the battery's charge was highest (s), and that charge."""

    def accept(self, report: VehicleReport) -> None:
        """Take what has happened so far as known: the operator lets the survey begin, or continue."""
        self.reboots, self.clock_jumps = report.reboots, report.clock_jumps

    def go_on(self, report: VehicleReport) -> None:
        """Let the survey continue on the operator's word, also with eyes that judge nothing, until they judge again."""
        self.accept(report)
        self._saw_s = math.inf

    def check(self, now: float, t: float, report: VehicleReport, pose: Pose | None) -> Breach | None:
        """Return the gravest breach of a limit, if any; `now` by the report's stamps, `t` since the beginning (s)."""
        found = [breach for breach in self._breaches(now, t, report, pose) if breach.action != "none"]
        return max(found, key=lambda breach: GRAVITY[breach.action], default=None)

    def _breaches(self, now: float, t: float, report: VehicleReport, pose: Pose | None) -> list[Breach]:
        cfg = self.cfg
        found = []
        news = max(report.pose_stamp_s, report.attitude_stamp_s, report.depth_stamp_s, report.velocity_stamp_s)
        if now - news > cfg.link_timeout_s or report.heartbeat_age_s > cfg.heartbeat_timeout_s:
            silent = min(now - news, report.heartbeat_age_s) if now - news <= cfg.link_timeout_s else now - news
            found.append(Breach("link", f"link lost: no news for {silent:.1f} s", cfg.on_link_lost, True))
        elif not report.has_position or now - report.pose_stamp_s > cfg.pose_timeout_s:
            age = now - report.pose_stamp_s
            told = f"{age:.1f} s old" if math.isfinite(age) else "none yet"
            found.append(Breach("pose", f"position lost: the last one is {told}", cfg.on_pose_lost, True))
        elif report.altitude_stamp_s < now - FLOOR_S and math.isfinite(report.altitude_stamp_s):
            silent = now - report.altitude_stamp_s
            found.append(Breach("floor", f"range to the floor lost: none for {silent:.1f} s", cfg.on_floor_lost, True))
        if report.reboots > self.reboots:
            found.append(Breach("reboot", "the autopilot restarted", cfg.on_reboot))
        if report.clock_jumps > self.clock_jumps:
            self.clock_jumps = report.clock_jumps  # one jump, one hold
            found.append(Breach("clock", "the autopilot's clock jumped", cfg.on_clock_jump, True))
        self._saw_s = t if self.sees_m() > 0.0 else self._saw_s
        if t - self._saw_s > cfg.unjudged_s:
            found.append(
                Breach("eyes", f"the eyes have judged nothing for {t - self._saw_s:.0f} s", cfg.on_unjudged, True)
            )
        if report.leak:
            found.append(Breach("leak", "leak: water inside the hull", cfg.on_leak))
        if report.battery_fraction is not None and report.battery_fraction < cfg.battery_min:
            found.append(Breach("battery", f"battery at {report.battery_fraction:.0%}", cfg.on_battery))
        elif report.battery_v is not None and report.battery_v < cfg.battery_min_v:
            found.append(Breach("battery", f"battery at {report.battery_v:.1f} V", cfg.on_battery))
        if abs(report.tether_turns) > cfg.tether_turns:
            found.append(Breach("tether", f"tether twisted by {report.tether_turns:+.1f} turns", cfg.on_tether))
        if pose is not None:
            if where := self.area.breach(pose.x, pose.y):
                found.append(Breach("fence", f"{where} at ({pose.x:.1f}, {pose.y:.1f}) m", cfg.on_fence))
            found += self._too_late(t, report, pose)
        return found

    def _too_late(self, t: float, report: VehicleReport, pose: Pose) -> list[Breach]:
        cfg, home = self.cfg, self.area.start
        way_m = math.dist(pose[:2], home[:2])
        need_s = way_m / cfg.return_speed_m_s + cfg.reserve_s
        battery_s = self._battery_left_s(t, report.battery_fraction)
        left_s = min(self.time_limit_s - t, battery_s)
        if left_s > need_s:
            return []
        told = "the time limit" if self.time_limit_s - t <= battery_s else "the battery"
        return [Breach("time", f"{left_s:.0f} s left by {told}, {way_m:.0f} m from the start", cfg.on_time)]

    def _battery_left_s(self, t: float, fraction: float | None) -> float:
        """Return the time (s) until the charge is at its limit, by a straight line; inf while nothing can be said."""
        if fraction is None:
            return math.inf
        if self._full is None or fraction > self._full[1]:
            self._full = (t, fraction)
        spent, since = self._full[1] - fraction, t - self._full[0]
        if since < 60.0 or spent < 0.02:
            return math.inf
        return max(0.0, fraction - self.cfg.battery_min) * since / spent
