"""Files of bags that a recorder did not finish, or a copy cut: what is whole of them, read as a file with an end.

An MCAP file is its magic bytes, records of an operation (1 byte), a length (8 bytes) and so much content, and the magic
bytes again (mcap.dev/spec); records that follow the data are an index, without which readers scan. A ROS 1 bag is
records of a header and data, each after its length (4 bytes), and at its end the index that its first record points to
(wiki.ros.org/Bags/Format/2.0). An SQLite file states how many pages it has (sqlite.org/fileformat2.html).
"""

from __future__ import annotations

import io
import os
import sqlite3
import struct
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from coral.errors import InputError
from coral.foreign_file import open_regular, open_sqlite, refuse_computed
from coral.limits import CHUNK_BYTES
from coral.words import many

MAGIC = b"\x89MCAP0\r\n"
_DATA_END = 0x0F
_END = struct.pack("<BQI", _DATA_END, 4, 0) + struct.pack("<BQQQI", 0x02, 20, 0, 0, 0) + MAGIC
_RECORD = struct.Struct("<BQ")

ROS1_MAGIC = b"#ROSBAG V2.0\n"
_MOST_HEADER = 65_536
"""Of a record's header in a ROS 1 bag: names and numbers (bytes)."""
_HEAD_OP, _INDEX_OP, _CHUNK_OP, _INFO_OP, _CONNECTION_OP = 3, 4, 5, 6, 7

_TABLES = ("schema", "topics", "message_definitions", "messages")
"""What a reader of ROS 2's SQLite files asks for; messages last."""


@dataclass(frozen=True)
class Mended:
    """A file without its end."""

    path: Any
    """What readers open in its place: a path, or what does as one."""
    told: str
    """What was left out, for the user."""


def mend(path: Path, folder: Path) -> Mended | None:
    """Return what is whole of a file of a bag; None if it has its end, is of another kind, or nothing of it is whole.

    What has to be copied is copied into `folder`.

    Raises:
        InputError: It may not be read: a table of it computes what is in it.
    """
    makers = {".mcap": _mend_mcap, ".bag": _mend_ros1, ".db3": _mend_sqlite}
    return makers[path.suffix](path, folder) if path.suffix in makers else None


class PathWithEnd:
    """A path whose file, opened to be read, has the end that it lacks. All else is the path's own."""

    def __init__(self, path: Path, whole: int, end: bytes, head: bytes = b"") -> None:
        """Take the first `whole` bytes of a file, those at its beginning replaced by `head`, and `end` after them."""
        self._path, self._whole, self._end, self._head = path, whole, end, head

    def __getattr__(self, name: str) -> Any:
        return getattr(self._path, name)

    def __str__(self) -> str:
        return str(self._path)

    def open(self, mode: str = "rb") -> BinaryIO:
        """Open the file. `mode` is "rb", as its readers ask for."""
        return io.BufferedReader(_Ended(open_regular(self._path), self._whole, self._end, self._head))


class _Ended(io.RawIOBase):
    """The first bytes of a file, with another head, and an end after them."""

    def __init__(self, file: BinaryIO, whole: int, end: bytes, head: bytes) -> None:
        self._file, self._whole, self._end, self._head, self._at = file, whole, end, head, 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET, /) -> int:
        start = (0, self._at, self._whole + len(self._end))[whence]
        self._at = start + offset
        return self._at

    def readinto(self, buffer: Any, /) -> int:
        room, left = len(buffer), self._whole - self._at
        if self._at < len(self._head):
            part = self._head[self._at : self._at + room]
        elif left > 0:
            self._file.seek(self._at)
            part = self._file.read(min(room, left))
        else:
            part = self._end[-left : room - left]
        buffer[: len(part)] = part
        self._at += len(part)
        return len(part)

    def close(self) -> None:
        self._file.close()
        super().close()


def _left_out(path: Path, count: int) -> str:
    return f"{path} has no end, unfinished or cut: its last {many(count, 'byte')} were left out, the rest was read"


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


def _mend_mcap(path: Path, folder: Path) -> Mended | None:
    with open_regular(path) as file:
        whole = whole_bytes(file)
        size = file.seek(0, os.SEEK_END)
    return None if whole is None else Mended(PathWithEnd(path, whole, _END), _left_out(path, size - whole))


@dataclass(frozen=True)
class _Ros1Record:
    begin: int
    fields: dict[bytes, bytes]
    data_at: int
    end: int
    """Its first byte, that of its data, and the first one after it."""

    @property
    def op(self) -> int:
        return self.fields.get(b"op", b"\0")[0]

    def number(self, name: bytes) -> int:
        return int.from_bytes(self.fields.get(name, b""), "little")


def _ros1_record(file: BinaryIO, at: int, size: int) -> _Ros1Record | None:
    """Return the record of a ROS 1 bag that begins at a byte; None if no whole one does."""
    file.seek(at)
    length = int.from_bytes(file.read(4), "little")
    if at + 8 > size or not 0 < length <= min(_MOST_HEADER, size - at - 8):
        return None
    header, fields, k = file.read(length), dict[bytes, bytes](), 0
    while k + 4 <= length:
        part = int.from_bytes(header[k : k + 4], "little")
        name, _, value = header[k + 4 : k + 4 + part].partition(b"=")
        fields[name], k = value, k + 4 + part
    data_at = at + 8 + length
    end = data_at + int.from_bytes(file.read(4), "little")
    return _Ros1Record(at, fields, data_at, end) if k == length and fields.get(b"op") and end <= size else None


def _ros1_records(file: BinaryIO, at: int, size: int) -> Iterator[_Ros1Record]:
    while (record := _ros1_record(file, at, size)) is not None:
        yield record
        at = record.end


def _mend_ros1(path: Path, folder: Path) -> Mended | None:
    with open_regular(path) as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        first = _ros1_record(file, len(ROS1_MAGIC), size) if file.read(len(ROS1_MAGIC)) == ROS1_MAGIC else None
        if first is None or first.op != _HEAD_OP:
            return None
        index = first.number(b"index_pos")
        if 0 < index <= size:
            ops = [record.op for record in _ros1_records(file, index, size)]
            if len(ops) == first.number(b"conn_count") + first.number(b"chunk_count"):
                return None
        whole, chunks = _ros1_chunks(file, first.end, size)
        if not chunks:
            return None
        try:
            connections = _ros1_connections(file, chunks)
        except (KeyError, ValueError, OSError, EOFError, RuntimeError):  # a chunk that cannot be unpacked
            return None
        file.seek(0)
        head = file.read(first.data_at)
    numbers = {
        b"index_pos=": struct.pack("<Q", whole), b"conn_count=": struct.pack("<I", len(connections)),
        b"chunk_count=": struct.pack("<I", len(chunks)),
    }  # fmt: skip
    for name, value in numbers.items():
        at = head.find(name) + len(name)
        head = head[:at] + value + head[at + len(value) :]
    end = b"".join([*connections.values(), *(_ros1_info(chunk, indexes) for chunk, indexes in chunks)])
    return Mended(PathWithEnd(path, whole, end, head), _left_out(path, size - whole))


_Indexes = dict[int, tuple[int, bytes, bytes]]
"""By connection: number of messages, and the first and the last time as they are written."""


def _ros1_chunks(file: BinaryIO, at: int, size: int) -> tuple[int, list[tuple[_Ros1Record, _Indexes]]]:
    """Return where the whole chunks end, and each with the indexes that follow it."""
    found: list[tuple[_Ros1Record, _Indexes]] = []
    whole, last = at, at
    for record in _ros1_records(file, at, size):
        if record.op == _CHUNK_OP and record.end - record.data_at <= CHUNK_BYTES:
            whole = record.begin  # so that all indexes of the chunk before are there
            found.append((record, {}))
        elif record.op == _INDEX_OP and found:
            count = record.number(b"count")
            if record.end - record.data_at != 12 * count or not count:
                break
            file.seek(record.data_at)
            ordered = sorted((time for (time,) in struct.iter_unpack("8s4x", file.read(12 * count))), key=_time_of)
            found[-1][1][record.number(b"conn")] = (count, ordered[0], ordered[-1])
        else:  # the index, or a chunk that was being written
            whole = record.begin
            break
        last = record.end
    if found and last == size and found[-1][1]:
        whole = size
    return whole, [one for one in found if one[1] and one[0].begin < whole]


def _ros1_connections(file: BinaryIO, chunks: list[tuple[_Ros1Record, _Indexes]]) -> dict[int, bytes]:
    """Return the record of each connection, which stands in the first chunk that has messages of it."""
    from rosbags.rosbag1.reader import decompressors

    found: dict[int, bytes] = {}
    for chunk, indexes in chunks:
        if set(indexes) <= set(found):
            continue
        file.seek(chunk.data_at)
        content = decompressors[chunk.fields[b"compression"].decode()](file.read(chunk.end - chunk.data_at))
        inner = io.BytesIO(content)
        for record in _ros1_records(inner, 0, len(content)):
            if record.op == _CONNECTION_OP:
                found.setdefault(record.number(b"conn"), content[record.begin : record.end])
    return found


def _time_of(written: bytes) -> tuple[int, ...]:
    return struct.unpack("<II", written)


def _ros1_info(chunk: _Ros1Record, indexes: _Indexes) -> bytes:
    fields = {
        b"op": bytes([_INFO_OP]), b"ver": struct.pack("<I", 1), b"chunk_pos": struct.pack("<Q", chunk.begin),
        b"start_time": min((one[1] for one in indexes.values()), key=_time_of),
        b"end_time": max((one[2] for one in indexes.values()), key=_time_of),
        b"count": struct.pack("<I", len(indexes)),
    }  # fmt: skip
    header = b"".join(struct.pack("<I", len(name) + 1 + len(v)) + name + b"=" + v for name, v in fields.items())
    data = b"".join(struct.pack("<II", number, one[0]) for number, one in indexes.items())
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def _sqlite_pages(path: Path) -> tuple[int, int]:
    """Return how many bytes of an SQLite file are whole pages, and how many it lacks to what it says; 0, 0 if none."""
    with open_regular(path) as file:
        head, size = file.read(100), file.seek(0, os.SEEK_END)
    # The number of pages holds only if it was written by who changed the file last.
    if len(head) < 100 or not head.startswith(b"SQLite format 3\0") or head[24:28] != head[92:96]:
        return 0, 0
    page = int.from_bytes(head[16:18], "big")
    page = 65_536 if page == 1 else max(page, 512)
    return size - size % page, max(page * int.from_bytes(head[28:32], "big") - size, 0)


def is_cut(path: Path) -> bool:
    """Check whether an SQLite file lacks pages that it says it has."""
    return _sqlite_pages(path)[1] > 0


def _whole_pages(path: Path, whole: int, folder: Path) -> Path:
    """Copy the whole pages of an SQLite file: of one that is cut, readers would take what is missing for zeros."""
    with open_regular(path) as file, tempfile.NamedTemporaryFile(dir=folder, suffix=".db3", delete=False) as out:
        while whole and (part := file.read(min(whole, 1_000_000))):
            out.write(part)
            whole -= len(part)
    return Path(out.name)


def _mend_sqlite(path: Path, folder: Path) -> Mended | None:
    whole, missing = _sqlite_pages(path)
    if not missing:
        return None
    out, copied, read = folder / path.name, _whole_pages(path, whole, folder), 0
    try:
        with open_sqlite(copied, damaged=True) as old, open_sqlite(out) as new:
            refuse_computed(old, str(path), *_TABLES)
            known = {str(row[0]) for row in old.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
            for name in (one for one in _TABLES if one in known):
                rows = old.execute(f"SELECT * FROM {name} NOT INDEXED")
                columns = ", ".join('"' + column[0].replace('"', '""') + '"' for column in rows.description)
                new.execute(f"CREATE TABLE {name} ({columns})")
                into = f"INSERT INTO {name} VALUES ({', '.join('?' * len(rows.description))})"
                try:
                    for row in rows:
                        new.execute(into, row)
                        read += name == "messages"
                except sqlite3.Error:
                    if name != "messages":
                        raise
            new.commit()
    except (sqlite3.Error, OSError) as error:
        raise InputError(
            str(path), "", f"a cut SQLite file ({error})", 'a whole one: `sqlite3 FILE ".recover" | sqlite3 NEW.db3`'
        ) from None
    finally:
        copied.unlink()
    if not read:
        return None
    told = (
        f"{path} has no end, unfinished or cut: {many(missing, 'byte')} are missing, {many(read, 'message')} were read"
    )
    return Mended(out, told)
