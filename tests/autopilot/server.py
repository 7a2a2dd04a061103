"""Serves a simulated autopilot over UDP or TCP, in real time, from a thread."""

from __future__ import annotations

import contextlib
import select
import socket
import threading
import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from autopilot.autopilot import SimulatedAutopilot
from autopilot.faults import FaultPlan, LineCondition, LinkFault
from coral.errors import InputError, first_line

PEERS = 8
LAG_S = 0.5
"""After a longer pause of the machine, time is not caught up."""


class AutopilotServer:
    """A thread that moves an autopilot's time with the clock, and its bytes to everyone connected.

    UDP peers become known by sending something; every peer gets all that the autopilot says, as behind BlueOS's router.
    """

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        medium: str = "udp",
        host: str = "127.0.0.1",
        port: int = 0,
        faults: Iterable[LinkFault] = (),
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Open a port (0: any free one) and start.

        Raises:
            InputError: The medium is neither udp nor tcp, or the port is taken.
        """
        if medium not in ("udp", "tcp"):
            raise InputError("autopilot", "medium", medium, "udp or tcp")
        autopilot.step(autopilot.cfg.step_s)  # compiles the dynamics, which would keep the first peers waiting
        self.autopilot, self.lock = autopilot, threading.Lock()
        """Hold the lock to touch the autopilot from another thread."""
        self._clock = clock
        self._udp = medium == "udp"
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM if self._udp else socket.SOCK_STREAM)
        try:
            if not self._udp:
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._socket.bind((host, port))
            if not self._udp:
                self._socket.listen(PEERS)
        except (OSError, OverflowError) as error:
            self._socket.close()
            raise InputError("autopilot", "port", f"{host}:{port} ({first_line(error)})", "a free port") from None
        self._socket.setblocking(False)
        self.host, self.port = self._socket.getsockname()[:2]
        self.line = LineCondition()
        """A broken or bad line, while the vehicle keeps moving."""
        self.happened: list[tuple[float, str]] = []
        """Faults that began or ended, with the autopilot's time (s)."""
        self._faults = FaultPlan(faults)
        self._rng = np.random.default_rng(0)
        self._peers: list[Any] = []
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, name="autopilot", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """The address for `--vehicle`."""
        return f"mavlink:{'udp' if self._udp else 'tcp'}:{self.host}:{self.port}"

    def close(self) -> None:
        """Stop and free the port."""
        self._closed.set()
        self._thread.join(timeout=2.0)
        for line in [self._socket, *([] if self._udp else self._peers)]:
            line.close()

    def _run(self) -> None:
        last = self._clock()
        while not self._closed.is_set():
            incoming = self._receive(0.01)
            now = self._clock()
            with self.lock:
                for data, peer in incoming:
                    if not self._lost():
                        self.autopilot.receive(data, peer)
                self.autopilot.step(min(now - last, LAG_S))
                self.happened += [
                    (self.autopilot.time_s, name) for name in self._faults.apply(self.autopilot, self.line)
                ]
                outgoing = self.autopilot.send()
            last = now
            if outgoing and not self._lost():
                self._send(outgoing)

    def _lost(self) -> bool:
        return self.line.silent or (self.line.loss > 0.0 and bool(self._rng.random() < self.line.loss))

    def _receive(self, timeout_s: float) -> list[tuple[bytes, Any]]:
        lines = [self._socket] if self._udp else [self._socket, *self._peers]
        try:
            ready = select.select(lines, [], [], timeout_s)[0]
        except (OSError, ValueError):
            return []
        found: list[tuple[bytes, Any]] = []
        for line in ready:
            with contextlib.suppress(BlockingIOError, ConnectionError):
                if self._udp:
                    data, peer = line.recvfrom(65536)
                    if peer not in self._peers:
                        self._peers = [*self._peers[1 - PEERS :], peer]
                    found.append((data, peer))
                elif line is self._socket:
                    peer, _ = line.accept()
                    peer.setblocking(False)
                    self._peers.append(peer)
                else:
                    found += self._read(line)
        return found

    def _read(self, line: socket.socket) -> list[tuple[bytes, Any]]:
        try:
            data = line.recv(65536)
        except ConnectionError:
            data = b""
        if data:
            return [(data, line.fileno())]
        self._peers.remove(line)
        line.close()
        return []

    def _send(self, data: bytes) -> None:
        for peer in list(self._peers):
            with contextlib.suppress(OSError):
                if self._udp:
                    for k in range(0, len(data), 1200):  # the codec at the other end puts frames together again
                        self._socket.sendto(data[k : k + 1200], peer)
                else:
                    peer.send(data)
