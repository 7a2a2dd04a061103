"""Where a vehicle is (`mavlink:udp:HOST:PORT` and its sisters), and bytes to and from it over UDP or TCP.

A broken line is silence, and is opened again.
"""

from __future__ import annotations

import contextlib
import select
import socket
import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, Literal, Protocol, get_args

from coral.errors import InputError, first_line, nearest

CHUNK = 65536
RETRY_S = 0.5
"""A broken TCP line is opened again so often."""
PEERS = 8
"""udpin answers this many of the last senders."""
Medium = Literal["udp", "udpin", "tcp"]
FORMS = {
    "mavlink:udpin:HOST:PORT": "Waits for a vehicle that sends here, as BlueOS does to QGroundControl's computer: add "
    "an endpoint for it, and take `udpin:0.0.0.0:14550`.",
    "mavlink:udp:HOST:PORT": "Speaks first to BlueOS, which listens (a UDP server endpoint).",
    "mavlink:tcp:HOST:PORT": "Connects to ArduSub in the loop, or to a TCP endpoint; again when it breaks.",
}
"""Addresses of a vehicle."""
EXPECTED = f"{', '.join(FORMS)}; with #ID behind it, the vehicle of that system id"


class Transport(Protocol):
    """A line that may lose bytes and never raises for it."""

    @property
    def sender(self) -> Hashable:
        """Who sent what `receive` returned last; None on a line that has one end."""

    def answer(self, peer: Hashable) -> None:
        """From now on send to this peer alone; None: to everybody who has been heard."""

    def receive(self, timeout_s: float) -> bytes:
        """Wait so long (s) at most for bytes; b"" if none came."""

    def send(self, data: bytes) -> None:
        """Send bytes, or drop them if that would block."""

    def close(self) -> None:
        """Free the port."""


class UdpLine:
    """UDP to a host, or from whoever sends to us."""

    def __init__(self, address: VehicleAddress) -> None:
        """Open the socket.

        Raises:
            InputError: The host is unknown, or the port is taken.
        """
        self._listens = address.medium == "udpin"
        self.sender: Hashable = None
        self._only: Any = None
        self.peers: list[Any] = []
        """Where to send to; senders, latest last, if we listen."""
        try:
            family, _, _, _, where = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(family, socket.SOCK_DGRAM)
            if self._listens:
                self._socket.bind(where)
            else:
                self.peers = [where]
        except OSError as error:
            expected = "a port that is free" if self._listens else "a known host"
            raise InputError(
                "--vehicle", "", f"{address.host}:{address.port} ({first_line(error)})", expected
            ) from None
        self._socket.setblocking(False)

    def receive(self, timeout_s: float) -> bytes:
        """Wait for one datagram."""
        try:
            if not select.select([self._socket], [], [], timeout_s)[0]:
                return b""
            data, sender = self._socket.recvfrom(CHUNK)
        except (OSError, ValueError):  # the peer's port is closed, or ours was closed meanwhile
            return b""
        if not self._listens and sender[:2] != self.peers[0][:2]:
            return b""  # we asked one host; anybody may send to our port
        if self._listens and sender not in self.peers:
            self.peers = [*self.peers[1 - PEERS :], sender]
        self.sender = sender
        return data

    def answer(self, peer: Hashable) -> None:
        """See `Transport.answer`."""
        self._only = peer

    def send(self, data: bytes) -> None:
        """Send one datagram to the peer that is answered, or to all."""
        for peer in self.peers if self._only is None else [self._only]:
            with contextlib.suppress(OSError):
                self._socket.sendto(data, peer)

    def close(self) -> None:
        """Free the port."""
        self._socket.close()


class TcpLine:
    """A line over TCP, opened again when it breaks."""

    sender = None

    def __init__(self, address: VehicleAddress, clock: Callable[[], float] = time.monotonic) -> None:
        self._place, self._clock = (address.host, address.port), clock
        self._line: socket.socket | None = None
        self._tried_s = -RETRY_S
        self._closed = False

    def _open(self) -> socket.socket | None:
        if self._line is None and not self._closed and self._clock() - self._tried_s >= RETRY_S:
            self._tried_s = self._clock()
            with contextlib.suppress(OSError):
                self._line = socket.create_connection(self._place, timeout=1.0)
                self._line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return self._line

    def _break(self) -> None:
        line, self._line = self._line, None
        if line is not None:
            with contextlib.suppress(OSError):
                line.close()

    def receive(self, timeout_s: float) -> bytes:
        """Wait for bytes."""
        line = self._open()
        if line is None:
            time.sleep(min(timeout_s, RETRY_S))
            return b""
        try:
            if not select.select([line], [], [], timeout_s)[0]:
                return b""
            data = line.recv(CHUNK)
        except (OSError, ValueError):
            data = b""
        if not data:
            self._break()
        return bytes(data)

    def answer(self, peer: Hashable) -> None:
        """There is one peer."""

    def send(self, data: bytes) -> None:
        """Send bytes if the line takes them now."""
        line = self._line
        try:
            if line is not None and select.select([], [line], [], 0.0)[1]:
                line.send(data)
        except (OSError, ValueError):
            self._break()

    def close(self) -> None:
        """Close the line for good."""
        self._closed = True
        self._break()


def open_transport(address: VehicleAddress) -> Transport:
    """Open a line to an address. A TCP line may come up later.

    Raises:
        InputError: The host is unknown, or the port is taken.
    """
    return TcpLine(address) if address.medium == "tcp" else UdpLine(address)


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
