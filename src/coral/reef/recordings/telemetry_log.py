"""A telemetry log (.tlog) of a ground station: MAVLink messages, each after the time when it came."""

from __future__ import annotations

from collections.abc import Iterator
from mmap import mmap
from typing import Any

from coral.errors import InputError
from coral.reef.recordings.dataflash_log import Sample
from coral.reef.sea.ardusub import AUTOPILOT_COMPONENT, has_position, load_dialect, range_down

LOCAL_NED = 1
"""MAV_FRAME_LOCAL_NED."""
STAMP = 8
WANTED = {
    30: "ATTITUDE", 32: "LOCAL_POSITION_NED", 33: "GLOBAL_POSITION_INT", 132: "DISTANCE_SENSOR", 173: "RANGEFINDER",
    193: "EKF_STATUS_REPORT", 331: "ODOMETRY",
}  # fmt: skip


def read_telemetry(content: mmap | bytes, where: str) -> Iterator[Sample]:
    """Read what the autopilot of a telemetry log says of its pose, in Unix time.

    Messages of other components and such with a wrong checksum are left out.

    Raises:
        InputError: pymavlink is not installed, or two vehicles speak.
    """
    dialect = load_dialect(where)
    codec = dialect.MAVLink(None)
    at, unread, vehicle = 0, 0, 0
    while at + STAMP + 8 <= len(content):
        begin, magic = at + STAMP, content[at + STAMP]
        if magic == dialect.PROTOCOL_MARKER_V2 and begin + 10 <= len(content):
            length = 12 + content[begin + 1] + (13 if content[begin + 2] & 1 else 0)
            system, component = content[begin + 5], content[begin + 6]
            number = int.from_bytes(content[begin + 7 : begin + 10], "little")
        elif magic == dialect.PROTOCOL_MARKER_V1:
            length = 8 + content[begin + 1]
            system, component, number = content[begin + 3], content[begin + 4], content[begin + 5]
        else:
            at, unread = at + 1, unread + 1
            continue
        if begin + length > len(content):
            break
        if number in WANTED and component == AUTOPILOT_COMPONENT:
            try:
                message = codec.decode(bytearray(content[begin : begin + length]))
            except dialect.MAVError:
                at, unread = at + 1, unread + 1
                continue
            if vehicle not in (0, system):
                expected = "a log of one; mavlogdump.py --source-system takes one out of it"
                raise InputError(where, "", f"vehicles {vehicle} and {system}", expected)
            vehicle = system
            sample = _sample(message)
            if sample is not None:
                yield sample[0], 1e-6 * int.from_bytes(content[at:begin], "big"), sample[1]
        at = begin + length
    yield "unread", 0.0, (float(unread + len(content) - at),)


def _sample(m: Any) -> tuple[str, tuple[float, ...]] | None:
    name = m.get_type()
    if name == "ATTITUDE":
        return "attitude", (m.roll, m.pitch, m.yaw)
    if name == "LOCAL_POSITION_NED" or (name == "ODOMETRY" and m.frame_id == LOCAL_NED):
        return "position", (m.y, m.x)
    if name == "GLOBAL_POSITION_INT" and (m.lat or m.lon):
        return "place", (1e-7 * m.lon, 1e-7 * m.lat)
    if name == "EKF_STATUS_REPORT":
        return "standing", (float(not has_position(m.flags)),)
    if name == "RANGEFINDER" and m.distance > 0.0:
        return "range", (m.distance,)
    if name == "DISTANCE_SENSOR" and (found := range_down(m)) is not None:
        return "range", (found,)
    return None
