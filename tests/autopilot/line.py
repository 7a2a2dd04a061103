"""A line to an autopilot in the same process, whose time goes on only while the line is read: for tests that repeat."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from autopilot.autopilot import SimulatedAutopilot


class AutopilotLine:
    """A `Transport` without a network. `clock` is the time of both ends.

    Faults on command: `cut` breaks the line in both directions, `loss` drops that share of the datagrams, `garble`
    flips a bit in that share of those that come, `delay_s` keeps them back.
    """

    sender: Hashable = None

    def __init__(self, autopilot: SimulatedAutopilot, rng: np.random.Generator | None = None) -> None:
        self.autopilot = autopilot
        self.cut = False
        self.loss = self.garble = self.delay_s = 0.0
        self._rng = rng or np.random.default_rng(0)
        self._waiting: list[tuple[float, bytes]] = []

    def clock(self) -> float:
        """Time since the beginning (s)."""
        return self.autopilot.time_s

    def receive(self, timeout_s: float) -> bytes:
        """Let time go on by `timeout_s`, and return what the autopilot has said."""
        self.autopilot.step(timeout_s)
        data = self.autopilot.send()
        if data and not self._lost():
            self._waiting.append((self.clock() + self.delay_s, self._garbled(data)))
        ready = [data for at, data in self._waiting if at <= self.clock()]
        self._waiting = [(at, data) for at, data in self._waiting if at > self.clock()]
        return b"".join(ready)

    def answer(self, peer: Hashable) -> None:
        """There is one peer."""

    def send(self, data: bytes) -> None:
        """Send bytes to the autopilot."""
        if not self._lost():
            self.autopilot.receive(data, "line")

    def close(self) -> None:
        """End the line."""
        self.cut = True

    def _lost(self) -> bool:
        return self.cut or (self.loss > 0.0 and bool(self._rng.random() < self.loss))

    def _garbled(self, data: bytes) -> bytes:
        if self.garble <= 0.0 or self._rng.random() >= self.garble:
            return data
        damaged = bytearray(data)
        damaged[int(self._rng.integers(len(damaged)))] ^= 1 << int(self._rng.integers(8))
        return bytes(damaged)
