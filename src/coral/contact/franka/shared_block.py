"""A block of numbers that one process writes and another reads, without locks: neither waits for the other.

A counter is odd while the block is written (a seqlock); a reader repeats until it has read between two equal even
counters, and after a few attempts takes what it read before. On a busy machine a writer may be interrupted for long in
the middle of its work, and a stream cannot wait for it.
"""

from __future__ import annotations

from multiprocessing.sharedctypes import RawArray
from typing import Any

import numpy as np

from coral.contact.scene.observation import Array

_ATTEMPTS = 20


class SharedBlock:
    """One writer, one reader. The object can be passed to a process that is spawned.

    Args:
        size: Count of numbers.
    """

    def __init__(self, size: int) -> None:
        self._raw: Any = RawArray("d", size + 1)
        self._last = np.zeros(size)

    def write(self, values: Array) -> None:
        """Write all numbers, Shape=(size,)."""
        view = np.frombuffer(self._raw)
        view[0] += 1.0
        view[1:] = values
        view[0] += 1.0

    def read(self) -> Array:
        """Return the newest numbers that could be read whole, Shape=(size,); zeros before the first write."""
        view = np.frombuffer(self._raw)
        for _ in range(_ATTEMPTS):
            before = view[0]
            if before % 2.0 == 0.0:
                found = view[1:].copy()
                if view[0] == before:
                    self._last = found
                    break
        return self._last
