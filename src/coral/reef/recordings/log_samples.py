"""What an autopilot's log says, sample by sample.

A dataflash log (.BIN) is the autopilot's own: records whose layout the file itself describes. A telemetry log (.tlog)
is a ground station's: MAVLink messages, each after the time when it came.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from mmap import mmap
from typing import Any

from coral.errors import InputError
from coral.reef.sea.ardusub import AUTOPILOT_COMPONENT, DOWN, has_position, load_dialect, range_down

SYNC, FORMAT = b"\xa3\x95", 128
_NEEDED = {
    "XKF1": {"PN", "PE"}, "XKF4": {"SS"}, "ATT": {"Roll", "Pitch", "Yaw"}, "POS": {"Lat", "Lng"},
    "GPS": {"Status", "GMS", "GWk"}, "RFND": {"Dist"},
}  # fmt: skip
_LAYOUT = struct.Struct("<BB4s16s64s")
_CODES = {code: code for code in "bBhHiIfdqQ"} | {
    "a": "64s", "g": "e", "n": "4s", "N": "16s", "Z": "64s", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "M": "B",
}  # fmt: skip
_SCALES = {"c": 0.01, "C": 0.01, "e": 0.01, "E": 0.01, "L": 1e-7}
GPS_EPOCH_S, LEAP_S = 315_964_800, 18
"""Beginning of GPS time in Unix time, and the leap seconds between them since 2017 (s)."""
RANGE_GOOD, FIX_3D = 4, 3
LOCAL_NED = 1
"""MAV_FRAME_LOCAL_NED."""
STAMP = 8
WANTED = {
    30: "ATTITUDE", 32: "LOCAL_POSITION_NED", 33: "GLOBAL_POSITION_INT", 132: "DISTANCE_SENSOR", 173: "RANGEFINDER",
    193: "EKF_STATUS_REPORT", 331: "ODOMETRY",
}  # fmt: skip

Sample = tuple[str, float, tuple[float, ...]]
"""What an estimator says, time (s), values. position: east, north (m); place: longitude, latitude; attitude: roll,
pitch, yaw (rad, of a body with z down in NED); range: distance to the sea floor (m); standing: 1 while the position is
not one, for want of measurements; clock: Unix time less that of the log (s); unread: bytes that are no message."""


def read_dataflash(content: mmap | bytes) -> Iterator[Sample]:
    """Read what a dataflash log says of the vehicle's pose, in seconds since the autopilot's start."""
    core = 0.0
    for name, t, values in _records(content):
        if name == "":
            yield "unread", t, (values["bytes"],)
        elif name == "XKF4":
            core = values.get("PI", 0.0)
            if values.get("C", 0.0) == core:
                status = values["SS"] if math.isfinite(values["SS"]) else 0.0
                yield "standing", t, (float(not has_position(int(status))),)
        elif name == "XKF1" and values.get("C", 0.0) == core:
            yield "position", t, (values["PE"], values["PN"])
        elif name == "ATT":
            yield "attitude", t, tuple(math.radians(values[angle]) for angle in ("Roll", "Pitch", "Yaw"))
        elif name == "POS" and (values["Lat"] or values["Lng"]):
            yield "place", t, (values["Lng"], values["Lat"])
        elif name == "GPS" and values["Status"] >= FIX_3D:
            yield "clock", t, (GPS_EPOCH_S - LEAP_S + 604_800 * values["GWk"] + 0.001 * values["GMS"] - t,)
        elif name == "RFND" and values.get("Stat", RANGE_GOOD) == RANGE_GOOD and values.get("Orient", DOWN) == DOWN:
            yield "range", t, (values["Dist"],)


def _records(content: mmap | bytes) -> Iterator[tuple[str, float, dict[str, float]]]:
    """Yield name, time and numbers of the wanted records; "" with a number of bytes for what is none."""
    lengths: dict[int, int] = {FORMAT: 3 + _LAYOUT.size}
    layouts: dict[int, tuple[str, struct.Struct, list[str], list[float]]] = {}
    at, t = 0, 0.0
    while at + 3 <= len(content):
        kind = content[at + 2]
        length = lengths.get(kind, 0) if content[at : at + 2] == SYNC else 0
        if not length:
            again = content.find(SYNC, at + 1)
            again = len(content) if again < 0 else again
            yield "", t, {"bytes": float(again - at)}
            at = again
            continue
        if at + length > len(content):
            yield "", t, {"bytes": float(len(content) - at)}
            return
        if kind == FORMAT:
            described, size, *texts = _LAYOUT.unpack_from(content, at + 3)
            name, codes, columns = (text.split(b"\0")[0].decode("latin-1") for text in texts)
            packed = struct.Struct("<" + "".join(_CODES.get(code, "") for code in codes))
            fields = columns.split(",")
            if size >= 3 and described != FORMAT:
                lengths[described] = size
                layouts.pop(described, None)
                whole = packed.size + 3 == size and len(fields) == len(codes)
                numbers = {field for field, code in zip(fields, codes, strict=False) if code not in "anNZ"}
                if whole and {"TimeUS", *_NEEDED.get(name, "-")} <= numbers:
                    layouts[described] = name, packed, fields, [_SCALES.get(code, 1.0) for code in codes]
        elif kind in layouts:
            name, packed, fields, scales = layouts[kind]
            found = zip(fields, packed.unpack_from(content, at + 3), scales, strict=True)
            values = {field: scale * value for field, value, scale in found if not isinstance(value, bytes)}
            t = 1e-6 * values["TimeUS"]
            yield name, t, values
        at += length


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
