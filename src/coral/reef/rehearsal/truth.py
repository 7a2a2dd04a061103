"""Where a simulated vehicle truly is, from SIM_STATE: for the double of a camera. The link never reads it."""

from __future__ import annotations

import contextlib
import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from coral.reef.sea import ardusub
from coral.reef.sea.frames import pose_from_ned
from coral.reef.sea.transport import Transport, VehicleAddress, open_transport
from coral.reef.world.geometry import Pose

SIM_STATE = 108
EARTH_M = 6_378_137.0
DEGREES = 1e-7


@dataclass(frozen=True, kw_only=True)
class TrueState:
    """A simulation's own state of its vehicle."""

    pose: Pose
    """ENU, from the first position on, which comes in steps of 1.1 cm."""
    depth_m: float
    stamp_s: float
    """Monotonic time of arrival."""


class TruthFeed:
    """Listens to a simulation on a line of its own, and asks for its state 20 times a second."""

    def __init__(
        self, address: VehicleAddress | Transport, system: int = 1, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Open the line. The first position is the origin."""
        self._dialect = ardusub.load_dialect()
        self._line = open_transport(address) if isinstance(address, VehicleAddress) else address
        self._clock, self._system = clock, system
        self._codec = self._dialect.MAVLink(None, 254, 191)
        self._codec.robust_parsing = True
        self._origin: tuple[float, float] | None = None
        self._state: TrueState | None = None
        self._asked_s = -math.inf
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    @property
    def state(self) -> TrueState | None:
        """The latest state; None before the first."""
        return self._state

    def run(self) -> TruthFeed:
        """Listen in a thread."""
        self._thread = threading.Thread(target=self._run, name="truth", daemon=True)
        self._thread.start()
        return self

    def close(self) -> None:
        """Stop listening."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        self._line.close()

    def _run(self) -> None:
        while not self._closed.is_set():
            self.poll()

    def poll(self) -> None:
        """Take what has come; ask again while nothing comes."""
        data, now = self._line.receive(0.02), self._clock()
        latest = -math.inf if self._state is None else self._state.stamp_s
        if now - max(latest, self._asked_s) > 1.0:
            self._asked_s = now
            request = self._dialect.MAVLink_command_long_message(
                self._system, ardusub.AUTOPILOT_COMPONENT, 511, 0, float(SIM_STATE), 50_000.0, 0, 0, 0, 0, 0
            )
            self._line.send(request.pack(self._codec))
        messages: list[Any] = []
        with contextlib.suppress(Exception):
            messages = self._codec.parse_buffer(data) or [] if data else []
        for message in messages:
            if message.get_type() == "SIM_STATE":
                self._take(message, now)

    def _take(self, message: Any, now: float) -> None:
        latitude, longitude = message.lat_int * DEGREES, message.lon_int * DEGREES
        if not all(math.isfinite(v) for v in (message.yaw, message.alt)) or not (latitude or longitude):
            return
        if self._origin is None:
            self._origin = (latitude, longitude)
        north = math.radians(latitude - self._origin[0]) * EARTH_M
        east = math.radians(longitude - self._origin[1]) * EARTH_M * math.cos(math.radians(self._origin[0]))
        pose = pose_from_ned(north, east, message.yaw)
        self._state = TrueState(pose=pose, depth_m=-message.alt, stamp_s=now)
