"""Where a simulated vehicle truly is, from SIM_STATE: for the double of a camera. The link never reads it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

from coral.reef.sea import ardusub
from coral.reef.sea.frames import pose_from_ned
from coral.reef.sea.latest_reading import LatestReading
from coral.reef.sea.transport import Transport, VehicleAddress, open_transport
from coral.reef.world.geometry import Pose

SIM_STATE = 108
EARTH_M = 6_378_137.0
DEGREES = 1e-7


class TrueState:
    """Asks a simulation, on a line of its own, for its state 20 times a second."""

    name = "SIM_STATE"

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
        self._told_s = self._asked_s = -math.inf

    def read(self) -> tuple[float, Pose] | None:
        """Return the monotonic time of arrival (s) and the pose, ENU from the first position on, in steps of 1.1 cm."""
        data, now = self._line.receive(0.02), self._clock()
        if now - max(self._told_s, self._asked_s) > 1.0:
            self._asked_s = now
            request = self._dialect.MAVLink_command_long_message(
                self._system, ardusub.AUTOPILOT_COMPONENT, 511, 0, float(SIM_STATE), 50_000.0, 0, 0, 0, 0, 0
            )
            self._line.send(request.pack(self._codec))
        messages = self._codec.parse_buffer(data) or [] if data else []
        poses = [self._pose(message) for message in messages if message.get_type() == "SIM_STATE"]
        pose = next((pose for pose in reversed(poses) if pose is not None), None)
        if pose is None:
            return None
        self._told_s = now
        return now, pose

    def close(self) -> None:
        """Free the line."""
        self._line.close()

    def _pose(self, message: Any) -> Pose | None:
        latitude, longitude = message.lat_int * DEGREES, message.lon_int * DEGREES
        if not math.isfinite(message.yaw) or not (latitude or longitude):
            return None
        if self._origin is None:
            self._origin = (latitude, longitude)
        north = math.radians(latitude - self._origin[0]) * EARTH_M
        east = math.radians(longitude - self._origin[1]) * EARTH_M * math.cos(math.radians(self._origin[0]))
        return pose_from_ned(north, east, message.yaw)


def follow_truth(address: VehicleAddress) -> LatestReading[tuple[float, Pose]]:
    """Follow a simulation's own state of its vehicle, on a thread."""
    return LatestReading(TrueState(address), "truth")
