"""A block of memory that one process writes and another reads, without locks: neither waits for the other.

A counter is odd while the block is written (a seqlock); a reader repeats until it has read between two equal even
counters, and after a few attempts takes what it read before. On a busy machine a writer may be interrupted for long in
the middle of its work, and a stream cannot wait for it.
"""

from __future__ import annotations

import pickle
from multiprocessing.sharedctypes import RawArray
from typing import Any, Generic, TypeVar

import numpy as np

T = TypeVar("T")
_ATTEMPTS = 20
_BYTES = 65_536
"""Room for a report with the poses of eighty objects."""


class SharedBlock(Generic[T]):
    """One writer, one reader. The object can be passed to a process that is spawned."""

    def __init__(self, first: T) -> None:
        self._head: Any = RawArray("q", 2)
        self._body: Any = RawArray("B", _BYTES)
        self._last, self._seen = first, 0

    def write(self, value: T) -> None:
        """Write a value.

        Raises:
            ValueError: It is too large.
        """
        data, head = pickle.dumps(value), np.frombuffer(self._head, np.int64)
        if len(data) > _BYTES:
            raise ValueError(f"{len(data)} bytes for a block of {_BYTES}")
        head[0] += 1
        head[1] = len(data)
        memoryview(self._body).cast("B")[: len(data)] = data
        head[0] += 1

    def read(self) -> T:
        """Return the newest value that could be read whole."""
        head = np.frombuffer(self._head, np.int64)
        for _ in range(_ATTEMPTS):
            before = int(head[0])
            if before == self._seen:
                break
            if before % 2 == 0:
                data = bytes(memoryview(self._body).cast("B")[: int(head[1])])
                if int(head[0]) == before:
                    self._last, self._seen = pickle.loads(data), before
                    break
        return self._last
