"""Where a vehicle is: `mavlink:udp:HOST:PORT` and its sisters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from coral.errors import InputError, nearest

Medium = Literal["udp", "udpin", "tcp"]
FORMS = {
    "mavlink:udpin:HOST:PORT": "Waits for a vehicle that sends here, as BlueOS does to QGroundControl's computer: add "
    "an endpoint for it, and take `udpin:0.0.0.0:14550`.",
    "mavlink:udp:HOST:PORT": "Speaks first to BlueOS, which listens (a UDP server endpoint).",
    "mavlink:tcp:HOST:PORT": "Connects to ArduSub in the loop, or to a TCP endpoint; again when it breaks.",
}
"""Addresses of a vehicle."""
EXPECTED = f"{', '.join(FORMS)}; with #ID behind it, the vehicle of that system id"


@dataclass(frozen=True)
class VehicleAddress:
    """A place to exchange bytes with an autopilot."""

    medium: Medium
    host: str
    port: int
    system: int = 0
    """MAVLink system id of the vehicle; 0: the only one on the line."""


def parse_address(text: str) -> VehicleAddress:
    """Read `mavlink:MEDIUM:WHERE:NUMBER`, or `mavlink:MEDIUM:WHERE:NUMBER#SYSTEM`.

    Raises:
        InputError: It is none of the three forms, or the number is out of range.
    """
    place, marked, system = text.partition("#")
    if marked and not (system.isascii() and system.isdigit() and len(system) < 4 and 1 <= int(system) <= 255):
        raise InputError("--vehicle", "system id", repr(system), "a number from 1 to 255")
    scheme, _, rest = place.partition(":")
    medium, _, rest = rest.partition(":")
    host, _, number = rest.rpartition(":")
    if scheme != "mavlink":
        raise InputError("--vehicle", "", repr(text), EXPECTED)
    if medium not in get_args(Medium):
        raise InputError("--vehicle", "", repr(text), f"{EXPECTED}{nearest(medium, get_args(Medium))}")
    if not host or not number.isascii() or not number.isdigit():
        raise InputError("--vehicle", "", repr(text), EXPECTED)
    if len(number) > 5 or not 1 <= int(number) <= 65_535:
        raise InputError("--vehicle", "port", number, "a number from 1 to 65535")
    return VehicleAddress(medium, host.strip("[]"), int(number), int(system or 0))  # type: ignore[arg-type]
