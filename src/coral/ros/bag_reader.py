"""Messages of a ROS 2 bag or an MCAP file, with one line for what is wrong in it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from coral.errors import InputError, first_line, install_extra
from coral.foreign_file import check_tables, read_head, read_text
from coral.limits import CHUNK_BYTES
from coral.yaml_file import load_mapping

FILES = (".mcap", ".db3", ".bag")
"""MCAP, SQLite of ROS 2, and ROS 1."""
EXPECTED = "a ROS bag or an MCAP file"
_CUT_SQLITE = (
    "a damaged SQLite file",
    'a whole one: `sqlite3 FILE ".recover" | sqlite3 NEW.db3`, then `ros2 bag reindex FOLDER`',
)
_MENDS = {
    "File end magic is invalid.": (
        "a file without an end, unfinished or cut",
        "a whole one: `mcap recover FILE -o OUT`, then `ros2 bag reindex FOLDER` if it is part of a folder",
    ),
    "Profile is not ros2.": (
        "an MCAP file of other messages",
        "messages of ROS 2 (profile ros2), or a folder of pictures with poses.csv",
    ),
    "Bag is not indexed": ("a ROS 1 bag without an index, unfinished or cut", "a whole one: `rosbag reindex FILE`"),
    "Bag index looks damaged": ("a ROS 1 bag without its end, cut", "a whole one: `rosbag reindex FILE`"),
    "Cannot open database": _CUT_SQLITE,
}
"""How what the library says begins, and what it means for who has the file."""


def is_bag(path: Path) -> bool:
    """Check whether a path is a ROS bag or an MCAP file, or a folder of such files."""
    return path.suffix in FILES or (path / "metadata.yaml").is_file() or bool(_loose_files(path))


def _loose_files(path: Path) -> list[Path]:
    """Return the parts of a bag whose metadata are missing, in order."""
    if not path.is_dir() or (path / "metadata.yaml").exists():
        return []
    return sorted(one for one in path.iterdir() if one.suffix in (".mcap", ".db3"))


class Bag:
    """A bag that is read several times.

    Raises:
        InputError: rosbags is not installed.
    """

    def __init__(self, path: Path) -> None:
        _library(path)
        self._path, self.where = path, str(path)

    def count_messages(self) -> dict[str, int]:
        """Return the number of messages on each topic.

        Raises:
            InputError: It is no bag.
        """
        found = dict[str, int]()
        with self._opened() as reader:
            for one in reader.connections:  # each part of a bag has its own
                found[one.topic] = found.get(one.topic, 0) + one.msgcount
        return found

    def message_types(self) -> dict[str, str]:
        """Return the type of the messages on each topic.

        Raises:
            InputError: It is no bag.
        """
        with self._opened() as reader:
            return {one.topic: one.msgtype for one in reader.connections}

    def read_messages(self, wanted: set[str]) -> Iterator[tuple[str, Any]]:
        """Return topic and message of all messages on some topics, in order of time, one after the other.

        Raises:
            InputError: It is no bag, or a message is damaged.
        """
        with self._opened() as reader:
            connections = [one for one in reader.connections if one.topic in wanted]
            if not connections:
                return
            try:
                for connection, _, raw in reader.messages(connections=connections):
                    try:
                        message = reader.deserialize(raw, connection.msgtype)
                    except Exception as error:  # a damaged message: the library has no common class for this
                        raise InputError(self.where, connection.topic, first_line(error), "a whole message") from None
                    yield connection.topic, message
            except InputError:
                raise
            except Exception as error:  # damaged bytes: no common class either
                raise InputError(self.where, "", first_line(error), "a whole file") from None

    @contextmanager
    def _opened(self) -> Iterator[Any]:
        from rosbags.typesys import Stores, get_typestore

        path = self._path
        _refuse_odd_files(path)
        try:
            types = get_typestore(Stores.ROS2_HUMBLE)
            reader = _library(path)(_loose_files(path) or [path], default_typestore=types)
            reader.open()
        except Exception as error:  # damaged bytes raise all kinds
            raise _cannot_open(path, error) from None
        try:
            yield reader
        finally:
            reader.close()


def stamp_of(message: Any) -> float:
    """Return the time of a message's header (s)."""
    stamp = message.header.stamp
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def _library(path: Path) -> Any:
    """Return the class that reads bags, which unpacks no more than a chunk holds.

    Raises:
        InputError: rosbags is not installed.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.rosbag1 import reader as rosbag1
        from rosbags.rosbag2 import storage_mcap
    except ImportError:
        raise InputError(str(path), "", "no package rosbags", install_extra("bags")) from None
    _bound_chunks(storage_mcap, rosbag1)
    return AnyReader


def _cannot_open(path: Path, error: Exception) -> InputError:
    # The library's own checks are assertions and failed conversions, whose texts say nothing of the file.
    told = "damaged bytes" if isinstance(error, AssertionError | TypeError | LookupError) else first_line(error)
    found, expected = next((said for start, said in _MENDS.items() if told.startswith(start)), (told, EXPECTED))
    return InputError(str(path), "", found, expected)


def _refuse_odd_files(path: Path) -> None:
    """Check what the library opens without limits: its files, the table of contents, compression of messages.

    Raises:
        InputError: A file is no regular one, or may not be read.
    """
    contents = _metadata(path)
    if str(contents.get("compression_mode", "")).lower() == "message":
        raise InputError(str(path), "compression_mode", "message", "a bag without it (`ros2 bag convert`)")
    for file in path.iterdir() if path.is_dir() else [path]:
        if file.suffix == ".db3":
            if _lacks_pages(file):  # SQLite itself may take what is missing for zeros
                raise InputError(str(file), "", *_CUT_SQLITE)
            check_tables(file, "messages", "topics")
        elif not file.is_dir():
            read_head(file, EXPECTED)


def _lacks_pages(path: Path) -> bool:
    """Check whether an SQLite file has fewer pages than its head says (sqlite.org/fileformat2.html)."""
    head = read_head(path, EXPECTED, 100)
    # The number of pages holds only if it was written by who changed the file last.
    if not head.startswith(b"SQLite format 3\0") or head[24:28] != head[92:96]:
        return False
    page = int.from_bytes(head[16:18], "big")
    return (65_536 if page == 1 else page) * int.from_bytes(head[28:32], "big") > path.stat().st_size


def _metadata(path: Path) -> dict[str, Any]:
    """Return what a ROS 2 bag's table of contents says; {} without one."""
    known = path / "metadata.yaml"
    if not known.exists():
        return {}
    about = load_mapping(read_text(known, EXPECTED), str(known)).get("rosbag2_bagfile_information")
    return about if isinstance(about, dict) else {}


def _bound_chunks(storage_mcap: Any, rosbag1: Any) -> None:
    """Make the library unpack no more of a chunk than it says that it holds, and no more than any chunk holds."""
    from bz2 import BZ2Decompressor

    from lz4.frame import LZ4FrameDecompressor

    def bounded(make: Any) -> Any:
        def unpack(data: bytes, size: int = CHUNK_BYTES) -> bytes:
            if size > CHUNK_BYTES:
                raise ValueError(f"a chunk of {size / 1e6:.0f} MB, where {CHUNK_BYTES / 1e6:.0f} are the most")
            found = bytes(make().decompress(data, max_length=size + 1))
            if len(found) > CHUNK_BYTES:
                raise ValueError(f"a chunk of more than {CHUNK_BYTES / 1e6:.0f} MB")
            return found

        return unpack

    lz4, zstd = bounded(LZ4FrameDecompressor), bounded(storage_mcap.zstd.ZstdDecompressor)
    rosbag1.decompressors.update(bz2=bounded(BZ2Decompressor), lz4=lz4)
    storage_mcap.DECOMPRESSORS.update(lz4=lz4, zstd=zstd)
