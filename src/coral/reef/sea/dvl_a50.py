"""A Water Linked DVL A50 over its TCP protocol: one JSON object per line, on port 16171.

Its axes are forward, right, down; its dead reckoning is in a frame that was fixed at its last reset. Source: the
manufacturer's protocol description ("Ethernet protocol (TCP)", formats json_v2 and json_v3).
"""

from __future__ import annotations

import math
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from coral.errors import InputError, first_line
from coral.foreign_file import parse_json
from coral.reef.sea.link import VehicleLink, VehicleReport
from coral.reef.world.geometry import Pose, wrap

PORT = 16171
TIMEOUT_S = 2.0
"""Without a line for this long the connection is made anew; the slowest rate of the device is 2 Hz."""
SILENT_S = 0.6
"""A velocity older than this is none: the device sends 4 to 15 a second, 2 at its slowest."""
MAX_LINE = 65_536
OLDEST_S = 1.0
"""A report that says it is older than this has a wrong clock; its arrival is taken instead."""


@dataclass(frozen=True, kw_only=True)
class DvlState:
    """What the DVL said last. Body FLU; the pose is in the frame of the last reset, x forward, y to the left."""

    velocity: tuple[float, float] | None = None
    """Over ground (m/s forward, m/s to the left)."""
    velocity_stamp_s: float = -math.inf
    velocity_std_m_s: float | None = None
    """Larger of the two horizontal standard deviations, or its figure of merit (m/s)."""
    altitude_m: float | None = None
    pose: Pose | None = None
    pose_stamp_s: float = -math.inf
    position_std_m: float | None = None
    bottom_lock: bool = False


def parse_line(line: bytes, now: float, state: DvlState) -> DvlState:
    """Return the state after one line of the device; lines that are no report of it change nothing.

    Args:
        line: One line, without its end.
        now: Monotonic time of its arrival (s).
        state: The state before.
    """
    try:
        report = parse_json(line)
        kind = report["type"]
        if kind == "velocity":
            return _with_velocity(report, now, state)
        if kind == "position_local":
            return _with_position(report, now, state)
    except (ValueError, TypeError, LookupError, RecursionError, OverflowError):
        pass
    return state


def _with_velocity(report: dict[str, Any], now: float, state: DvlState) -> DvlState:
    if report["velocity_valid"] is not True:
        return replace(state, bottom_lock=False)
    forward, right, altitude = (_finite(report[key]) for key in ("vx", "vy", "altitude"))
    age = 1e-6 * (_finite(report.get("time_of_transmission", 0)) - _finite(report.get("time_of_validity", 0)))
    covariance = report.get("covariance")
    spread = math.sqrt(max(_finite(covariance[k][k]) for k in (0, 1))) if covariance else _finite(report["fom"])
    return replace(
        state,
        velocity=(forward, -right),
        velocity_stamp_s=now - (age if 0.0 <= age <= OLDEST_S else 0.0),
        velocity_std_m_s=spread,
        altitude_m=altitude,
        bottom_lock=True,
    )


def _with_position(report: dict[str, Any], now: float, state: DvlState) -> DvlState:
    if report.get("status", 0) != 0:
        return state
    x, y, yaw, std = (_finite(report[key]) for key in ("x", "y", "yaw", "std"))
    return replace(state, pose=Pose(x, -y, wrap(-math.radians(yaw))), pose_stamp_s=now, position_std_m=std)


def _finite(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(value)
    return number


class DvlA50:
    """Reads the device on a thread of its own, and connects again when it falls silent."""

    def __init__(self, host: str, port: int = PORT, clock: Callable[[], float] = time.monotonic) -> None:
        """Connect.

        Raises:
            InputError: Nothing answers there.
        """
        self.host, self.port = host, port
        self.state = DvlState()
        self.failure = ""
        self._clock = clock
        self._closing = threading.Event()
        try:
            self._socket = socket.create_connection((host, port), TIMEOUT_S)
        except OSError as error:
            found = f"{host}:{port}, {error.strerror or error}"
            raise InputError("--dvl", "", found, "the address of a DVL A50, such as a50:192.168.2.95") from None
        self._thread = threading.Thread(target=self._work, name="coral-dvl", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Disconnect."""
        self._closing.set()
        self._socket.close()
        self._thread.join(2.0 * TIMEOUT_S)

    def _work(self) -> None:
        while not self._closing.is_set():
            try:
                self._read()
            except OSError as error:
                self.failure = first_line(error)
            self._connect_again()

    def _read(self) -> None:
        rest = b""
        while not self._closing.is_set():
            data = self._socket.recv(4096)
            if not data:
                raise OSError("the DVL closed the connection")
            *lines, rest = (rest + data).split(b"\n")
            rest = rest if len(rest) <= MAX_LINE else b""
            for line in lines:
                self.state = parse_line(line, self._clock(), self.state)
            self.failure = ""

    def _connect_again(self) -> None:
        self._socket.close()
        while not self._closing.wait(0.5):
            try:
                self._socket = socket.create_connection((self.host, self.port), TIMEOUT_S)
                return
            except OSError as error:
                self.failure = first_line(error)


class LinkWithDvl:
    """A vehicle whose pose and velocity come from a DVL of its own instead of the autopilot."""

    def __init__(self, link: VehicleLink, dvl: DvlA50) -> None:
        self.link, self.dvl = link, dvl
        self.arm, self.disarm, self.hold, self.surface = link.arm, link.disarm, link.hold, link.surface
        self.command = link.command

    def report(self) -> VehicleReport:
        """Return the autopilot's report with the DVL's pose and velocity; the yaw rate stays the autopilot's."""
        return merge(self.link.report(), self.dvl.state)

    def close(self) -> None:
        """Close both."""
        self.dvl.close()
        self.link.close()


class LinkWatchedByDvl:
    """A vehicle whose autopilot makes the position from a DVL, and whose silence is seen at the DVL itself.

    An estimator continues by dead reckoning (7.5 s in ArduSub) with fresh stamps; its messages do not show it.
    """

    def __init__(self, link: VehicleLink, dvl: DvlA50, clock: Callable[[], float] = time.monotonic) -> None:
        self.link, self.dvl, self._clock = link, dvl, clock
        self.arm, self.disarm, self.hold, self.surface = link.arm, link.disarm, link.hold, link.surface
        self.command = link.command

    def report(self) -> VehicleReport:
        """Return the autopilot's report; without a fresh velocity over ground its position is no position."""
        return watched(self.link.report(), self.dvl.state, self._clock())

    def close(self) -> None:
        """Close both."""
        self.dvl.close()
        self.link.close()


def watched(report: VehicleReport, state: DvlState, now: float) -> VehicleReport:
    """Return a report whose position is lost, and as old as the DVL's last velocity, if that is missing or old."""
    if state.bottom_lock and now - state.velocity_stamp_s <= SILENT_S:
        return replace(report, altitude_m=state.altitude_m)
    return replace(report, has_position=False, pose_stamp_s=min(report.pose_stamp_s, state.velocity_stamp_s))


def merge(report: VehicleReport, state: DvlState) -> VehicleReport:
    """Return a report whose pose and velocity are the DVL's."""
    turning = report.velocity[2] if report.velocity is not None else 0.0
    velocity = None if state.velocity is None else (*state.velocity, turning)
    return replace(
        report,
        pose=state.pose,
        pose_stamp_s=state.pose_stamp_s,
        has_position=state.pose is not None and state.bottom_lock,
        position_std_m=state.position_std_m,
        position_test_ratio=None,
        velocity=velocity,
        velocity_stamp_s=state.velocity_stamp_s,
        velocity_std_m_s=state.velocity_std_m_s,
        altitude_m=state.altitude_m if state.bottom_lock else None,
    )
