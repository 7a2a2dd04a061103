"""MCAP files that a recorder did not finish, or a copy cut: what is whole of them, read as a file with an end.

A file is its magic bytes, records of an operation (1 byte), a length (8 bytes) and so much content, and the magic bytes
again (mcap.dev/spec). Records that follow the data are an index, without which readers scan.
"""

from __future__ import annotations

import io
import os
import struct
from pathlib import Path
from typing import Any, BinaryIO

from coral.foreign_file import open_regular

MAGIC = b"\x89MCAP0\r\n"
_DATA_END = 0x0F
_END = struct.pack("<BQI", _DATA_END, 4, 0) + struct.pack("<BQQQI", 0x02, 20, 0, 0, 0) + MAGIC
_RECORD = struct.Struct("<BQ")


def whole_bytes(file: BinaryIO) -> int | None:
    """Return how many bytes from the start are whole records of data; None if the file has its end or is no MCAP."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(size - len(MAGIC), 0))
    ended = file.read(len(MAGIC)) == MAGIC
    file.seek(0)
    if ended or file.read(len(MAGIC)) != MAGIC:
        return None
    at = len(MAGIC)
    while at + _RECORD.size <= size:
        file.seek(at)
        operation, length = _RECORD.unpack(file.read(_RECORD.size))
        if operation in (0, _DATA_END) or at + _RECORD.size + length > size:
            break
        at += _RECORD.size + length
    return at


class UnfinishedMcap:
    """A path whose file, opened to be read, has the end that it lacks. All else is the path's own."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __getattr__(self, name: str) -> Any:
        return getattr(self._path, name)

    def __str__(self) -> str:
        return str(self._path)

    def open(self, mode: str = "rb") -> BinaryIO:
        """Open the file. `mode` is "rb", as its readers ask for."""
        file = open_regular(self._path)
        whole = whole_bytes(file)
        file.seek(0)
        return file if whole is None else io.BufferedReader(_Ended(file, whole))


class _Ended(io.RawIOBase):
    """The first bytes of a file, and an end after them."""

    def __init__(self, file: BinaryIO, whole: int) -> None:
        self._file, self._whole, self._at = file, whole, 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET, /) -> int:
        start = (0, self._at, self._whole + len(_END))[whence]
        self._at = start + offset
        return self._at

    def readinto(self, buffer: Any, /) -> int:
        room, left = len(buffer), self._whole - self._at
        if left > 0:
            self._file.seek(self._at)
            part = self._file.read(min(room, left))
        else:
            part = _END[-left : room - left]
        buffer[: len(part)] = part
        self._at += len(part)
        return len(part)

    def close(self) -> None:
        self._file.close()
        super().close()
