"""Who speaks on the link: autopilots by address, system and what they say they are, and which one is our vehicle."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Any

from coral.reef.sea import ardusub

RECENT_S = 5.0
"""A station that has been silent for longer is gone."""
MOST = 8
"""This many stations are remembered; a flood of senders pushes out those heard longest ago, never our vehicle."""
HISTORY, TORN = 64, 6
"""Two senders behind one address are assumed when TORN of the last HISTORY messages break their numbering."""
BREAK = range(101, 250)
"""A step in the numbers of messages (modulo 256) that neither a few lost nor a few late messages explain."""
NO_AUTOPILOT = 8
"""MAV_AUTOPILOT_INVALID: ground stations, cameras."""


@dataclass
class Station:
    """One autopilot that has been heard."""

    peer: Hashable
    """Address and port on UDP; None on a line that has one end."""
    system: int
    kind: int
    """MAV_TYPE."""
    maker: int
    """MAV_AUTOPILOT."""
    heard_s: float
    answered: bool = False
    """Whether it has reacted to something that we asked."""
    _number: int | None = None
    _breaks: deque[bool] = field(default_factory=lambda: deque(maxlen=HISTORY))

    def count(self, number: int) -> None:
        """Take the number of a message, 0 to 255."""
        if self._number is not None:
            self._breaks.append((number - self._number - 1) % 256 in BREAK)
        self._number = number

    @property
    def torn(self) -> bool:
        """Whether its messages come in two orders at once, so that two senders share its identity."""
        return sum(self._breaks) >= TORN


class Stations:
    """The autopilots on a link. The first that fits `system` is the vehicle; nobody else speaks for it."""

    def __init__(self, system: int = 0) -> None:
        """Wait for a system id; 0: the first autopilot heard."""
        self._wanted = system
        self.vehicle: Station | None = None
        self._others: dict[tuple[Hashable, int], Station] = {}

    def take(self, message: Any, peer: Hashable, now: float) -> bool:
        """Take one message that came from `peer` at `now` (s). Return whether the vehicle's address sent it."""
        system = message.get_srcSystem()
        autopilot = message.get_srcComponent() == ardusub.AUTOPILOT_COMPONENT
        if autopilot and message.get_type() == "HEARTBEAT" and message.autopilot != NO_AUTOPILOT:
            self._heartbeat(message, peer, now)
        vehicle = self.vehicle
        if vehicle is None or peer != vehicle.peer:
            return False
        if autopilot and system == vehicle.system:
            vehicle.count(message.get_seq())
        return True

    def _heartbeat(self, message: Any, peer: Hashable, now: float) -> None:
        key = (peer, message.get_srcSystem())
        vehicle = self.vehicle
        station = vehicle if vehicle and key == (vehicle.peer, vehicle.system) else self._others.pop(key, None)
        if station is None:
            station = Station(peer, key[1], message.type, message.autopilot, now)
        station.kind, station.maker, station.heard_s = message.type, message.autopilot, now
        if station is vehicle:
            return
        if vehicle is None and self._wanted in (0, station.system):
            self.vehicle = station
            return
        self._others[key] = station
        while len(self._others) > MOST:
            del self._others[next(iter(self._others))]

    def answered(self) -> None:
        """Note that the vehicle has reacted to something that we asked."""
        if self.vehicle is not None:
            self.vehicle.answered = True

    def moved(self, now: float) -> bool:
        """Follow the vehicle to another address once its own is silent. Return whether it has moved."""
        vehicle = self.vehicle
        if vehicle is None or now - vehicle.heard_s <= RECENT_S:
            return False
        heirs = [station for station in self._recent(now) if station.system == vehicle.system]
        if len(heirs) != 1:
            return False
        self.vehicle = self._others.pop((heirs[0].peer, heirs[0].system))
        return True

    def _recent(self, now: float) -> list[Station]:
        return [station for station in self._others.values() if now - station.heard_s <= RECENT_S]

    def faults(self, now: float) -> tuple[str, ...]:
        """Say why the vehicle is not known for sure, at `now` (s). While there is a reason, it is not armed."""
        vehicle = self.vehicle
        if vehicle is None:
            return ()
        told = []
        if vehicle.maker != ardusub.ARDUPILOT:
            told.append(f"its autopilot is {ardusub.maker_name(vehicle.maker)}, not ArduPilot")
        if vehicle.kind != ardusub.SUBMARINE:
            told.append(f"it calls itself type {vehicle.kind}, not a submarine (12)")
        for other in self._recent(now):
            if other.system == vehicle.system:
                told.append(
                    f"a second sender calls itself system {other.system}, at {place(other.peer)} beside "
                    f"{place(vehicle.peer)}: give each vehicle a MAV_SYSID of its own, or stop one"
                )
            elif not self._wanted:
                told.append(
                    f"systems {vehicle.system} and {other.system} are on the line: name one, as in "
                    f"mavlink:udpin:HOST:PORT#{vehicle.system}"
                )
        if vehicle.torn:
            told.append(f"two senders call themselves system {vehicle.system}: their messages come mixed on one line")
        if not vehicle.answered:
            told.append("it has answered nothing yet: a recording, or a line that carries one way only")
        return tuple(told)


def place(peer: Hashable) -> str:
    """Write an address for people."""
    return f"{peer[0]}:{peer[1]}" if isinstance(peer, tuple) and len(peer) >= 2 else str(peer or "the same line")
