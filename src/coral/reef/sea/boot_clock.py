"""When was a value measured? The autopilot stamps with its time since boot; this clock says when that was for us."""

from __future__ import annotations

import math

WINDOW_S = 5.0
"""The offset is the smallest of the last one to two windows: a slower clock of the autopilot is followed."""
JUMP_S = 1.0
"""A step of the autopilot's clock by more than this is no jitter."""
ROUND_TRIP_S = 0.1
"""TIMESYNC replies that took longer are not used."""
CONFIRM = 3
"""A restart is believed after this many messages in a row from the past; fewer are late packets."""


class BootClock:
    """Estimates the offset between the autopilot's clock and ours.

    A message needs at least 0 s to arrive, so the smallest of (arrival - stamp) is the best bound of the offset: the
    fastest packet is right and the others were late. A TIMESYNC reply bounds it from both sides.
    """

    def __init__(self) -> None:
        self.reboots = 0
        """Restarts seen."""
        self.jumps = 0
        """Steps forward of the autopilot's clock."""
        self._reset()

    def _reset(self) -> None:
        self._now = self._before = math.inf
        self._window_s = -math.inf
        self._latest = -math.inf
        self._past = 0

    def _learn(self, offset: float, now: float) -> None:
        if now - self._window_s >= WINDOW_S:
            self._before = self._now if now - self._window_s < 2 * WINDOW_S else math.inf
            self._now, self._window_s = math.inf, now
        self._now = min(self._now, offset)

    @property
    def offset_s(self) -> float:
        """Our monotonic time when the autopilot booted (s); inf while unknown."""
        return min(self._now, self._before)

    def stamp(self, boot_s: float, now: float) -> float | None:
        """Return our time (s, never later than now) at which the autopilot's clock showed `boot_s`.

        None for a packet that seems to come from before: a late one, or the first ones after a restart.
        """
        offset = now - boot_s
        if boot_s < self._latest - JUMP_S:
            self._past += 1
            if self._past < CONFIRM:
                return None
            self._reset()
            self.reboots += 1
        elif offset < self.offset_s - JUMP_S and self.offset_s < math.inf:
            self._reset()
            self.jumps += 1
        self._past = 0
        self._latest = max(self._latest, boot_s)
        self._learn(offset, now)
        return min(now, boot_s + self.offset_s)

    def synchronise(self, sent: float, autopilot_s: float, now: float) -> None:
        """Take a TIMESYNC reply: asked at `sent`, answered at the autopilot's time, received now (s).

        A fast reply replaces what was learnt before, so that an autopilot whose clock falls behind is followed at once.
        """
        if 0.0 <= now - sent <= ROUND_TRIP_S:
            self._now = self._before = 0.5 * (sent + now) - autopilot_s
            self._window_s = now
