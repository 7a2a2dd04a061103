"""Tiny logs of an autopilot, as files."""

import struct

from coral.reef.sea import ardusub

RECORDS = {
    "XKF1": (76, "QBff", "TimeUS,C,PN,PE"),
    "XKF4": (79, "QBIb", "TimeUS,C,SS,PI"),
    "ATT": (100, "QccC", "TimeUS,Roll,Pitch,Yaw"),
    "POS": (102, "QLL", "TimeUS,Lat,Lng"),
    "GPS": (118, "QBIHLL", "TimeUS,Status,GMS,GWk,Lat,Lng"),
    "RFND": (175, "QCBB", "TimeUS,Dist,Stat,Orient"),
}
CODES = {"c": "h", "C": "H", "L": "i"}
START_S = 1_683_220_600.0


def dataflash(*records, known=RECORDS):
    """Return a .BIN of records (name, time in s since start, raw values)."""
    out = b""
    for name, (kind, codes, columns) in known.items():
        size = 3 + struct.calcsize("<" + "".join(CODES.get(code, code) for code in codes))
        out += struct.pack(
            "<2sBBB4s16s64s", b"\xa3\x95", 128, kind, size, name.encode(), codes.encode(), columns.encode()
        )
    for name, t, *values in records:
        kind, codes, _ = known[name]
        packed = "<2sB" + "".join(CODES.get(code, code) for code in codes)
        out += struct.pack(packed, b"\xa3\x95", kind, round(t * 1e6), *values)
    return out


def dataflash_dive(seconds=4):
    """Return a .BIN of a vehicle that goes north at 0.5 m/s and looks north-east, nose 10 degrees down."""
    found = []
    for k in range(10 * seconds + 1):
        t = 100.0 + 0.1 * k
        found += [("XKF1", t, 0, 0.05 * k, 3.0), ("ATT", t, 0, -1000, 4500)]
    return dataflash(*found)


def telemetry(*messages):
    """Return a .tlog of messages (time in s since START_S, system, component, message)."""
    out = b""
    for t, system, component, message in messages:
        codec = ardusub.load_dialect().MAVLink(None, system, component)
        out += struct.pack(">Q", round((START_S + t) * 1e6)) + message.pack(codec)
    return out


def message(name, **values):
    """Return a message; fields that are not given are 0."""
    kind = getattr(ardusub.load_dialect(), f"MAVLink_{name.lower()}_message")
    return kind(**{field: values.get(field, 0) for field in kind.ordered_fieldnames})


def telemetry_dive(seconds=4):
    """Return a .tlog of the same dive, at half the rate."""
    found = []
    for k in range(5 * seconds + 1):
        position = message("local_position_ned", x=0.1 * k, y=3.0, z=4.0)
        attitude = message("attitude", pitch=-0.17453292, yaw=0.78539816)
        found += [(0.2 * k, 1, 1, position), (0.2 * k, 1, 1, attitude)]
    return telemetry(*found)
