"""A block of numbers that one process writes and another reads, without locks: a reader never holds the writer up.

A counter is odd while the block is written (a seqlock); a reader repeats until it has read between two equal even
counters. Without a lock, a process that dies cannot leave the other one waiting.
"""

from __future__ import annotations

from multiprocessing.sharedctypes import RawArray
from typing import Any

import numpy as np

from coral.contact.scene.observation import Array

_ATTEMPTS = 10_000


class SharedBlock:
    """One writer, one reader. The object can be passed to a process that is spawned.

    Args:
        size: Count of numbers.
    """

    def __init__(self, size: int) -> None:
        self._raw: Any = RawArray("d", size + 1)

    def write(self, values: Array) -> None:
        """Write all numbers, Shape=(size,)."""
        view = np.frombuffer(self._raw)
        view[0] += 1.0
        view[1:] = values
        view[0] += 1.0

    def read(self) -> Array:
        """Return the numbers that were written last, Shape=(size,); zeros before the first write.

        Raises:
            TimeoutError: The writer died while it wrote.
        """
        view = np.frombuffer(self._raw)
        for _ in range(_ATTEMPTS):
            before = view[0]
            if before % 2.0 == 0.0:
                found = view[1:].copy()
                if view[0] == before:
                    return np.asarray(found)
        raise TimeoutError("the writer of a shared block died while it wrote")
