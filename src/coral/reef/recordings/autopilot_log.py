"""The vehicle's pose by its autopilot's log: a dataflash log (.BIN) or a ground station's telemetry log (.tlog)."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from mmap import ACCESS_READ, mmap
from pathlib import Path

from coral.errors import InputError
from coral.foreign_file import open_regular, read_head
from coral.limits import AUTOPILOT_LOG_BYTES, AUTOPILOT_SAMPLES, LARGEST_NUMBER, LATEST_S
from coral.reef.recordings.log_samples import Sample, read_dataflash, read_telemetry
from coral.reef.recordings.transforms import NEAR_S, StampedTransforms, body_transform, euler_of
from coral.reef.world.geometry import Pose, wrap
from coral.words import many

SUFFIXES = (".tlog", ".bin")
EXPECTED = "an ArduPilot dataflash log (.BIN) or a telemetry log (.tlog)"
APART_S = 0.04
"""Poses are kept this far apart at least."""
GAP_S = 1.5
"""Telemetry has positions at 1 to 4 Hz: farther apart than this nothing is interpolated."""
UNIX_S = 1e9
"""Later times are Unix time, earlier ones are counted from the autopilot's start."""

_Series = list[tuple[float, tuple[float, ...]]]


@dataclass(frozen=True)
class LogTrack:
    """Where the vehicle was, by its log; times in seconds of the log's clock."""

    position: StampedTransforms
    """x east and y north of the estimator's origin (m), or longitude and latitude (degrees)."""
    in_degrees: bool
    place: StampedTransforms
    """Longitude and latitude of the same estimator, empty if it knows none."""
    attitude: StampedTransforms
    """Of the body, FLU in ENU."""
    range: StampedTransforms
    """z: distance to the sea floor along the body's down axis (m); empty without a range finder."""
    remark: str
    """What could not be read; "" if nothing."""

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of a position."""
        return self.position.span

    def at(self, t: float) -> dict[str, float] | None:
        """Return the columns of `poses.csv` at a time, with z where the log has a range; None without a pose."""
        position, turned, down = self.position.at(t), self.attitude.at(t), self.range.at(t)
        if position is None or turned is None or (down is None and self.range.times):
            return None
        roll, pitch, yaw = euler_of(turned[:3, :3])
        x, y = float(position[0, 3]), float(position[1, 3])
        found = {"roll": roll, "pitch": pitch}
        if self.in_degrees:
            found |= {"lat": y, "lon": x, "heading": 90.0 - math.degrees(yaw)}
        else:
            found |= {"x": x, "y": y, "yaw": yaw}
        if down is not None:
            found["z"] = float(down[2, 3]) * math.cos(roll) * math.cos(pitch)
        return found


def read_log(path: Path) -> LogTrack:
    """Read an autopilot's log. What is cut off or damaged in it is left out.

    Raises:
        InputError: It is none, has no positions or attitudes, or its clock goes back.
    """
    where = str(path)
    if not read_head(path, EXPECTED):
        raise InputError(where, "", "an empty file", EXPECTED)
    with open_regular(path) as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        if len(content) > AUTOPILOT_LOG_BYTES:
            raise InputError(where, "", f"{len(content) / 1e6:.0f} MB", f"at most {AUTOPILOT_LOG_BYTES / 1e6:.0f} MB")
        samples = read_dataflash(content) if path.suffix.lower() == ".bin" else read_telemetry(content, where)
        series, unread = _sort(samples, where)
    states = series.get("standing", [])
    position, place = (
        [one for one in series.get(kind, []) if not _stands(states, one[0])] for kind in ("position", "place")
    )
    position = position or place
    if not position:
        raise InputError(
            where, "position",
            "an estimator that stood still for want of a DVL or a GPS" if states else "no messages",
            "LOCAL_POSITION_NED or GLOBAL_POSITION_INT, or in a .BIN XKF1 or POS; otherwise poses.csv",
        )  # fmt: skip
    if not series.get("attitude"):
        raise InputError(where, "attitude", "no messages", "ATTITUDE (.tlog) or ATT (.BIN)")
    turns = ((t, (0.0, 0.0, 0.0, math.pi / 2 - yaw, roll, -pitch)) for t, (roll, pitch, yaw) in series["attitude"])
    try:
        return LogTrack(
            position=_track(position),
            in_degrees=position is place,
            place=_track(place),
            attitude=_track(turns),
            range=_track((t, (0.0, 0.0, *down)) for t, down in series.get("range", [])),
            remark=f"{path.name}: {many(unread, 'byte')} of damaged or cut off messages left out" if unread else "",
        )
    except ValueError as error:
        raise InputError(where, "time", error, "a clock that never goes back; cut the log there") from None


def tell_span(begin: float, end: float) -> str:
    """Describe two times of a clock, Unix time or the time since the autopilot's start."""
    if begin < UNIX_S:
        return f"{begin:.1f} to {end:.1f} s"
    first, last = (f"{datetime.fromtimestamp(t, UTC):%Y-%m-%d %H:%M:%S} UTC" for t in (begin, end))
    return f"{first} ({begin:.1f} s) to {last} ({end:.1f} s)"


def _sort(samples: Iterable[Sample], where: str) -> tuple[dict[str, _Series], int]:
    """Return the samples of each kind, in Unix time if the log knows it, and how many bytes were none."""
    series: dict[str, _Series] = {}
    unread, kept, shift = 0.0, 0, 0.0
    for kind, t, values in samples:
        if kind == "unread":
            unread += values[0]
        elif kind == "clock":
            shift = values[0] if not shift and UNIX_S < values[0] < LATEST_S else shift
        elif not (0.0 <= t <= LATEST_S and all(abs(value) <= LARGEST_NUMBER for value in values)):
            continue
        elif kind not in series or not 0.0 <= t - series[kind][-1][0] < APART_S:
            series.setdefault(kind, []).append((t, values))
            kept += 1
            if kept > AUTOPILOT_SAMPLES:
                raise InputError(where, "", f"more than {AUTOPILOT_SAMPLES} poses", "the log of a dive; cut it")
    return {kind: [(t + shift, values) for t, values in _steady(found)] for kind, found in series.items()}, int(unread)


def _steady(found: _Series) -> _Series:
    """Return samples without those whose stamp alone is off: no checksum protects stamps."""
    late = [math.inf if k + 1 == len(found) else found[k + 1][0] for k in range(len(found))]
    early = [-math.inf if k == 0 else found[k - 1][0] for k in range(len(found))]
    return [one for one, a, b in zip(found, early, late, strict=True) if a - NEAR_S <= one[0] <= b + NEAR_S]


def _stands(states: _Series, t: float) -> bool:
    k = bisect.bisect_right(states, t, key=lambda state: state[0])
    return bool(states) and states[max(k - 1, 0)][1][0] > 0.0


def _track(rows: Iterable[tuple[float, tuple[float, ...]]]) -> StampedTransforms:
    """Return transforms of x and y, and z, yaw, roll, pitch where they are known."""
    track = StampedTransforms(gap_s=GAP_S)
    for t, row in rows:
        x, y, z, yaw, roll, pitch = (*row, *(0.0,) * (6 - len(row)))
        track.add(t, body_transform(Pose(x, y, wrap(yaw)), z, roll, pitch))
    return track
