"""A file of the Sonar 3D-15's packets (.sonar) beside a recording: its range images, placed where the camera went."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from coral.errors import InputError
from coral.foreign_file import open_regular
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.recordings.recording import PosedFrame, PosedPing, Recording
from coral.reef.sea.sonar_packets import SonarPing, decode_packet, load_protocol, read_packets
from coral.reef.vehicle.sensing import Attitude
from coral.reef.world.geometry import Pose, wrap

APART_S = 2.0
"""Between two pictures farther apart than this nobody knows where the sonar was."""


def add_sonar_file(recording: Recording, path: Path, sonar: SonarCfg, start_s: float | None = None) -> Recording:
    """Return a recording with the range images of a file, in place of what it may have of a sonar.

    The sonar is taken to sit at the camera, tilted as `sonar` says. Its pose is interpolated between pictures; range
    images before the first one, after the last one and in long pauses are left out, and so are packets that are broken.
    `start_s` is the time of the recording at which the file begins (s). None: both tell the same time.

    Raises:
        InputError: It is no such file, wlsonar is not installed, or pictures and file share no time.
    """
    first, last = _span(path)
    times = [one.t for one in recording.keyframes()]
    shift_s = 0.0 if start_s is None else start_s - first.device_s
    begin, end = first.device_s + shift_s, last.device_s + shift_s
    if not times or end < times[0] or begin > times[-1]:
        raise InputError(
            str(path), "time", f"{begin:.3f} to {end:.3f} s",
            f"times within the recording's, {times[0]:.3f} to {times[-1]:.3f} s; --sonar-start-s says when it begins"
            if times else "a recording with pictures",
        )  # fmt: skip
    height, width = first.image.ranges.shape
    beams = replace(
        sonar, enabled=True, height=height, width=width, hfov_deg=first.image.hfov_deg, vfov_deg=first.image.vfov_deg
    )

    def keyframes() -> Iterator[PosedFrame]:
        pings = _pings(path)
        ahead = next(pings, None)
        before: PosedFrame | None = None
        for keyframe in recording.keyframes():
            heard = []
            while ahead is not None and ahead.device_s + shift_s <= keyframe.t + 1e-9:
                t = ahead.device_s + shift_s
                if before is not None and keyframe.t - before.t <= APART_S:
                    heard.append(_place(ahead, t, before, keyframe))
                ahead = next(pings, None)
            yield replace(keyframe, pings=tuple(heard))
            before = keyframe

    return replace(recording, keyframes=keyframes, sonar=beams)


def _place(ping: SonarPing, t: float, before: PosedFrame, after: PosedFrame) -> PosedPing:
    share = (t - before.t) / max(after.t - before.t, 1e-9)

    def between(a: float, b: float) -> float:
        return a + share * (b - a)

    a, b = before.pose, after.pose
    pose = Pose(between(a.x, b.x), between(a.y, b.y), wrap(a.theta + share * wrap(b.theta - a.theta)))
    attitude = Attitude(
        roll=between(before.roll, after.roll),
        pitch=between(before.pitch, after.pitch),
        depth_m=math.inf,
        altitude_m=between(before.height_m, after.height_m),
    )
    return PosedPing(t=t, pose=pose, attitude=attitude, image=ping.image)


def _span(path: Path) -> tuple[SonarPing, SonarPing]:
    """Return the first and the last range image."""
    first = last = None
    for last in _pings(path):
        first = first or last
    if first is None or last is None:
        raise InputError(str(path), "", "no range image", "range images of a Sonar 3D-15 (.sonar)")
    return first, last


def _pings(path: Path) -> Iterator[SonarPing]:
    """Yield the range images in order of time; what is cut off at the end has been lost with the logger's power."""
    load_protocol()
    latest = -math.inf
    try:
        with open_regular(path) as file:
            for packet in read_packets(file):
                try:
                    ping = decode_packet(packet)
                except UnfitMeasurement:
                    continue
                if ping is not None and ping.device_s >= latest:
                    latest = ping.device_s
                    yield ping
    except OSError as error:
        raise InputError("--sonar-file", "", str(path), f"a recording of the sonar ({error.strerror})") from None
    except UnfitMeasurement as unfit:
        if unfit.reason != "cut off":
            raise InputError(
                str(path), "", f"{unfit.reason} {unfit.detail}", "packets of a Sonar 3D-15 (.sonar)"
            ) from None
