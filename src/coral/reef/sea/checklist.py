"""The preflight list: what the vehicle has, how good it is, what is missing, and what that means."""

from __future__ import annotations

import math
from dataclasses import dataclass

from coral.check_line import CheckLine, level_of
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.pilot.checks import UnfitMeasurement, check_colours, check_range_image
from coral.reef.sea.latest_reading import KEPT, LatestReading, LatestShot, rate_of, rate_told
from coral.reef.sea.link import VehicleReport
from coral.reef.sea.safety import SafetyCfg, SailCfg
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.vehicle.sensing import HeardImage
from coral.reef.world.geometry import wrap

SLOW_HZ = 4.0
"""A pose or a camera slower than this is told: between two of them the vehicle drives 0.15 m."""
HEADING_RAD = math.radians(30.0)


class StampRates:
    """Measures how often each input of the vehicle really comes: when a new time stamp is first seen."""

    def __init__(self) -> None:
        self._stamps: dict[str, float] = {}
        self._came: dict[str, list[float]] = {}

    def note(self, now: float, report: VehicleReport) -> None:
        """Take in one report, at a monotonic time (s)."""
        for name in ("pose", "velocity", "attitude", "depth"):
            stamp = getattr(report, f"{name}_stamp_s")
            if math.isfinite(stamp) and stamp > self._stamps.get(name, -math.inf):
                self._stamps[name] = stamp
                self._came[name] = [*self._came.get(name, ())[-KEPT:], now]

    def rate_hz(self, name: str) -> float | None:
        """Return the mean rate of the last values (Hz); None if it is not known."""
        return rate_of(self._came.get(name, ()))


@dataclass(frozen=True, kw_only=True)
class Equipment:
    """What was chosen on the command line, for the list."""

    vehicle: str
    pose_source: str
    """Such as "autopilot"."""
    advisor: str
    folder: str
    judged: bool = False
    """Whether the conditions of a mission in words are known, and the truth."""
    heading_trusted: bool
    """Whether the vehicle's heading is taken as it is (compass), or the start's heading in its place."""
    resumed: str = ""
    """Run folder of the survey whose map goes on, and what is known of its landmarks; "" for a new one."""


def preflight_list(
    now: float,
    report: VehicleReport,
    rates: StampRates,
    camera: LatestShot,
    area: SurveyArea,
    cfg: SailCfg,
    equipment: Equipment,
    sonar: LatestReading[HeardImage] | None = None,
) -> list[CheckLine]:
    """Make the list at a monotonic time (s)."""
    safety, mission = cfg.safety, cfg.mission
    words = " ".join(mission.planner.instruction.text.split())
    judge = "judged by the truth of the simulated reef" if equipment.judged else "nobody judges it"
    return [
        _link(report, equipment),
        _pose(now, report, rates, equipment, safety),
        *([_heading(report, area)] if equipment.heading_trusted and report.yaw_rad is not None else []),
        _velocity(report, rates),
        _depth(report, rates, safety),
        *_camera(now, camera, mission.perception),
        _sonar(now, sonar, mission.simulator.sonar),
        _battery(report, safety),
        CheckLine(
            "leak",
            f"{safety.on_leak} if detected" if not report.leak else "water inside the hull",
            level_of(report.leak),
        ),
        CheckLine("tether", f"{report.tether_turns:+.1f} turns, {safety.on_tether} beyond {safety.tether_turns:g}"),
        CheckLine(
            "area",
            f"{area.name}, {area.size_m[0]:g} x {area.size_m[1]:g} m, start ({area.start.x:g}, {area.start.y:g}); "
            f"geofence with {len(area.fence)} corners, {len(area.keep_out)} keep-outs: {safety.on_fence}",
        ),
        CheckLine(
            "time", f"{mission.time_limit_s:g} s, then {safety.on_time}; home within {safety.reserve_s:g} s of it"
        ),
        *([_resumed(equipment, area)] if equipment.resumed else []),
        *([CheckLine("instruction", f"{words} - {judge}")] if words else []),
        CheckLine("advisor", equipment.advisor),
        CheckLine("recording", equipment.folder),
    ]


def _resumed(equipment: Equipment, area: SurveyArea) -> CheckLine:
    x, y, theta = area.start
    place = f"({x:g}, {y:g}) m, heading {math.degrees(theta):.0f} degrees"
    return CheckLine("map", f"that of {equipment.resumed}: the vehicle must now be about {place}")


def _link(report: VehicleReport, equipment: Equipment) -> CheckLine:
    if not math.isfinite(report.heartbeat_age_s):
        return CheckLine("vehicle", f"{equipment.vehicle}: no heartbeat - will not arm", "blocking")
    text = f"{report.autopilot or 'version unknown'} at {equipment.vehicle}"
    if report.identity_faults:
        return CheckLine("vehicle", f"{text}: {'; '.join(report.identity_faults)} - will not arm", "blocking")
    mode = f"mode {report.mode or 'unknown'}, {'ARMED' if report.armed else 'disarmed'}"
    return CheckLine("vehicle", f"{text}, {mode}")


def _pose(now: float, report: VehicleReport, rates: StampRates, equipment: Equipment, safety: SafetyCfg) -> CheckLine:
    source, rate = equipment.pose_source, rates.rate_hz("pose")
    if not report.has_position or report.pose is None:
        return CheckLine("pose", f"none from the {source} - will not arm without a position", "blocking")
    if report.covariance is not None:
        spread = f"standard deviation {math.sqrt(max(report.covariance[0, 0], report.covariance[1, 1])):.2g} m"
    elif report.position_test_ratio is not None:
        spread = f"no covariance reported, innovation {report.position_test_ratio:.2f} of its limit"
    else:
        spread = "no covariance reported"
    age = now - report.pose_stamp_s
    if age > safety.pose_timeout_s:
        return CheckLine("pose", f"{source}, {age:.1f} s old - will not arm on an old position", "blocking")
    slow = " - slow: the map blurs" if rate is not None and rate < SLOW_HZ else ""
    return CheckLine("pose", f"{source}, {rate_told(rate)}, {spread}{slow}", "lacking" if slow else "good")


def _heading(report: VehicleReport, area: SurveyArea) -> CheckLine:
    assert report.yaw_rad is not None
    off = wrap(report.yaw_rad - area.start.theta)
    text = f"compass, {math.degrees(off):+.0f} degrees from the start's"
    if abs(off) > HEADING_RAD:
        return CheckLine("heading", f"{text} - is the compass calibrated, is the vehicle at the start?", "lacking")
    return CheckLine("heading", text)


def _velocity(report: VehicleReport, rates: StampRates) -> CheckLine:
    if report.velocity is None:
        return CheckLine("velocity", "none - the controller needs it; will not arm", "blocking")
    return CheckLine("velocity", rate_told(rates.rate_hz("velocity")))


def _depth(report: VehicleReport, rates: StampRates, safety: SafetyCfg) -> CheckLine:
    if report.depth_m is None:
        return CheckLine("depth", "none - the depth cannot be held; will not arm", "blocking")
    text = f"{report.depth_m:.1f} m, {rate_told(rates.rate_hz('depth'))}"
    if report.altitude_m is not None:
        return CheckLine("depth", f"{text}; {report.altitude_m:.1f} m above the floor")
    if safety.on_floor_lost != "none":
        return CheckLine("depth", f"{text}; no range to the floor - its limit cannot act", "lacking")
    return CheckLine("depth", text)


def _camera(now: float, camera: LatestShot, perception: str) -> list[CheckLine]:
    shot, name = camera.latest, camera.source.name
    if shot is None:
        why = f" ({camera.failure})" if camera.failure else ""
        return [CheckLine("camera", f"{name}: no picture{why} - will not arm", "blocking")]
    age = now - shot.stamp_s
    rgb = shot.rgb if shot.frame is None else shot.frame.rgb
    try:
        if rgb is not None:
            check_colours(rgb)
    except UnfitMeasurement as unfit:
        told = f"{name}: {unfit.reason} ({unfit.detail}) - is the lens covered, the light off? will not arm"
        return [CheckLine("camera", told, "blocking")]
    lines = [CheckLine("camera", f"{name}, {rate_told(camera.rate_hz)}, last picture {max(age, 0.0):.1f} s old")]
    if shot.frame is not None:
        seen = "exact, from the simulated camera"
        if camera.eyes is not None:
            seen = f"{perception}, {1e3 * camera.seeing_s:.0f} ms a picture"
        return [*lines, CheckLine("labels", seen)]
    told = "none - its pictures have no classes and no depth: add --perception rgb or FILE.onnx; will not arm"
    return [*lines, CheckLine("labels", told, "blocking")]


def _sonar(now: float, sonar: LatestReading[HeardImage] | None, cfg: SonarCfg) -> CheckLine:
    if sonar is None:
        return CheckLine("sonar", "none - obstacles from the camera alone", "lacking")
    name, heard = sonar.source.name, sonar.latest
    if heard is None:
        why = f" ({sonar.failure})" if sonar.failure else ""
        return CheckLine("sonar", f"{name}: no image{why} - will not arm", "blocking")
    image = heard.value
    size = f"{image.ranges.shape[1]}x{image.ranges.shape[0]}, {image.hfov_deg:g} by {image.vfov_deg:g} degrees"
    text = f"{name}, {size}, {rate_told(sonar.rate_hz)}, last image {max(now - heard.t, 0.0):.1f} s old"
    refused = ", ".join(f"{reason} {count}" for reason, count in sonar.refused.most_common(3))
    text += f"; refused: {refused}" if refused else ""
    try:
        check_range_image(image, cfg, least_heard=0.0)
    except UnfitMeasurement as unfit:
        return CheckLine("sonar", f"{text}; {unfit.reason} ({unfit.detail}) - will not arm", "blocking")
    if sonar.rate_hz is not None and sonar.rate_hz < SLOW_HZ:
        return CheckLine("sonar", f"{text} - slow: it counts as lost between two images", "lacking")
    return CheckLine("sonar", text)


def _battery(report: VehicleReport, safety: SafetyCfg) -> CheckLine:
    if report.battery_fraction is None and report.battery_v is None:
        return CheckLine("battery", "not reported - its limit cannot act", "lacking")
    told = [] if report.battery_v is None else [f"{report.battery_v:.1f} V"]
    told += [] if report.battery_fraction is None else [f"{report.battery_fraction:.0%}"]
    limit = f"{safety.on_battery} below {safety.battery_min:.0%}"
    if report.battery_fraction is None and not safety.battery_min_v:
        return CheckLine(
            "battery", f"{', '.join(told)}; no share of charge is told and no voltage limit is set", "lacking"
        )
    low = report.battery_fraction is not None and report.battery_fraction < safety.battery_min
    return CheckLine("battery", f"{', '.join(told)}, {limit}", level_of(low))
