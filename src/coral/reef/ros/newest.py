"""The newest message of a topic, with its stamp on our clock."""

from __future__ import annotations

import contextlib
import queue
import time
from typing import Any

from coral.ros.ros_node import OtherClockError, RosNode

OLD_S = 60.0
"""What is of another clock counts as this old."""


class Newest:
    """Keeps one message; an older one that nobody has taken is dropped."""

    def __init__(self, ros: RosNode) -> None:
        self._ros = ros
        self._kept: queue.Queue[tuple[float, Any]] = queue.Queue(1)

    def hear(self, message: Any) -> None:
        """Keep a message."""
        try:
            stamp_s = self._ros.monotonic(message.header.stamp)
        except OtherClockError:
            stamp_s = time.monotonic() - OLD_S
        while True:
            try:
                self._kept.put_nowait((stamp_s, message))
                return
            except queue.Full:
                with contextlib.suppress(queue.Empty):
                    self._kept.get_nowait()

    def take(self, timeout_s: float) -> tuple[float, Any] | None:
        """Wait for a message; return its monotonic time (s) and itself, or None if there was none."""
        try:
            return self._kept.get(timeout=timeout_s)
        except queue.Empty:
            return None
