"""A Water Linked Sonar 3D-15 on the network: its packets over UDP, sent to a multicast group or to this computer."""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Callable

from coral.errors import InputError
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea.boot_clock import BootClock
from coral.reef.sea.sonar_packets import decode_packet, load_protocol
from coral.reef.vehicle.sensing import HeardImage

GROUP, PORT = "224.0.0.96", 4747
"""Where the sonar sends as it comes from its maker."""
WAIT_S = 0.2
"""One call waits this long for a packet."""
LARGEST_DATAGRAM = 65_535
"""Longer than any packet, so that a packet that is too long is seen to be."""


class UdpSonar:
    """Receives packets on a port, from the sonar that was heard first."""

    def __init__(
        self, port: int = PORT, interface: str = "0.0.0.0", clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Listen on a port, 0 for a free one, at this computer's address on the sonar's network, if it is on several.

        Raises:
            InputError: The port is in use, or wlsonar is not installed.
        """
        load_protocol()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._socket.bind(("", port))
        except (OSError, OverflowError) as error:
            self._socket.close()
            reason = getattr(error, "strerror", None) or error
            raise InputError("--sonar", "", f"UDP port {port}: {reason}", "a port that is free") from None
        self.multicast = self._join(interface)
        """Whether the group of the sonar could be joined; without it only packets to this computer arrive."""
        self._socket.settimeout(WAIT_S)
        self.port: int = self._socket.getsockname()[1]
        self.sender = ""
        """Address of the sonar, once it was heard."""
        self._clock, self._device = clock, BootClock()

    def _join(self, interface: str) -> bool:
        with contextlib.suppress(OSError):  # no such interface, or none that can
            group = socket.inet_aton(GROUP) + socket.inet_aton(interface)
            self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
            return True
        return False

    @property
    def name(self) -> str:
        """Port and sender."""
        where = f"Sonar 3D-15 at UDP port {self.port}"
        return f"{where}, from {self.sender}" if self.sender else where

    def read(self) -> HeardImage | None:
        """Wait for a packet; None if none came, or another message of the protocol."""
        try:
            packet, (host, *_) = self._socket.recvfrom(LARGEST_DATAGRAM)
        except TimeoutError:
            return None
        now = self._clock()
        ping = decode_packet(packet)
        if ping is None:
            return None
        if self.sender not in ("", host):
            raise UnfitMeasurement("another sender", f"{host}, not {self.sender}")
        self.sender = host
        stamp = self._device.stamp(ping.t, now) if ping.t > 0.0 else now
        return None if stamp is None else HeardImage(stamp, ping.value)

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()
