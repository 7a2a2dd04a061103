"""A dataflash log (.BIN), the autopilot's own: records whose layout the file itself describes."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from mmap import mmap

from coral.reef.sea.ardusub import DOWN, has_position

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
