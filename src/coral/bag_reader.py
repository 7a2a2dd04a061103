"""Messages of a ROS 2 bag or an MCAP file, with one line for what is wrong in it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, cast

from coral.errors import InputError, first_line, install_extra
from coral.foreign_file import check_tables, open_regular, read_head, read_text
from coral.limits import CHUNK_BYTES
from coral.unfinished_mcap import UnfinishedMcap, whole_bytes
from coral.yaml_file import load_mapping

FILES = (".mcap", ".db3", ".bag")
"""MCAP, SQLite of ROS 2, and ROS 1."""
_MENDS = {
    "File end magic is invalid.": (
        "a file without an end, unfinished or cut",
        "a whole one: `mcap recover FILE -o OUT`",
    ),
    "Profile is not ros2.": (
        "an MCAP file of other messages",
        "messages of ROS 2 (profile ros2), or a folder of pictures with poses.csv",
    ),
}
"""What the library says, and what it means for who has the file."""


def is_bag(path: Path) -> bool:
    """Check whether a path is a ROS bag or an MCAP file, or a folder of such files."""
    return path.suffix in FILES or (path / "metadata.yaml").is_file() or bool(_loose_files(path))


def _loose_files(path: Path) -> list[Path]:
    """Return the parts of a bag whose metadata are missing, in order."""
    if not path.is_dir() or (path / "metadata.yaml").exists():
        return []
    return sorted(one for one in path.iterdir() if one.suffix in (".mcap", ".db3"))


def bytes_cut(path: Path) -> int | None:
    """Return how many bytes at the end of MCAP files are no whole record; None where each file has its end."""
    cut = list[int]()
    for part in path.glob("*.mcap") if path.is_dir() else [path]:
        with open_regular(part) as file:
            whole = whole_bytes(file)
            if whole is not None:
                cut.append(file.seek(0, os.SEEK_END) - whole)
    return sum(cut) if cut else None


def count_messages(path: Path, *, unfinished: bool = False) -> dict[str, int]:
    """Return the number of messages on each topic; `unfinished` takes what is whole of MCAP files without an end.

    Raises:
        InputError: It is no bag, or rosbags is not installed.
    """
    with _opened(path, unfinished=unfinished) as reader:
        return {one.topic: one.msgcount for one in reader.connections}


def message_types(path: Path) -> dict[str, str]:
    """Return the type of the messages on each topic.

    Raises:
        InputError: It is no bag, or rosbags is not installed.
    """
    with _opened(path) as reader:
        return {one.topic: one.msgtype for one in reader.connections}


def read_messages(path: Path, wanted: set[str], *, unfinished: bool = False) -> Iterator[tuple[str, Any]]:
    """Return topic and message of all messages on some topics, in order of time, one after the other.

    `unfinished` takes what is whole of MCAP files without an end.

    Raises:
        InputError: It is no bag, a message is damaged, or rosbags is not installed.
    """
    with _opened(path, unfinished=unfinished) as reader:
        connections = [one for one in reader.connections if one.topic in wanted]
        if not connections:
            return
        try:
            for connection, _, raw in reader.messages(connections=connections):
                try:
                    message = reader.deserialize(raw, connection.msgtype)
                except Exception as error:  # a damaged message: the library has no common class for this
                    raise InputError(str(path), connection.topic, first_line(error), "a whole message") from None
                yield connection.topic, message
        except InputError:
            raise
        except Exception as error:  # damaged bytes: no common class either
            raise InputError(str(path), "", first_line(error), "a whole file") from None


def stamp_of(message: Any) -> float:
    """Return the time of a message's header (s)."""
    stamp = message.header.stamp
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


@contextmanager
def _opened(path: Path, *, unfinished: bool = False) -> Iterator[Any]:
    try:
        from rosbags.highlevel import AnyReader, anyreader
        from rosbags.rosbag1 import reader as rosbag1
        from rosbags.rosbag2 import storage_mcap
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(str(path), "", "no package rosbags", install_extra("bags")) from None
    _refuse_odd_files(path)
    _bound_chunks(storage_mcap, rosbag1)
    _remember_definitions(anyreader)
    try:
        parts = _loose_files(path) or [path]
        if unfinished:
            parts = [cast(Path, UnfinishedMcap(part)) if part.suffix == ".mcap" else part for part in parts]
        reader = AnyReader(parts, default_typestore=get_typestore(Stores.ROS2_HUMBLE))
        reader.open()
    except Exception as error:  # damaged bytes raise all kinds
        raise _cannot_open(path, error) from None
    try:
        yield reader
    finally:
        reader.close()


def _cannot_open(path: Path, error: Exception) -> InputError:
    # The library's own checks are assertions and failed conversions, whose texts say nothing of the file.
    told = "damaged bytes" if isinstance(error, AssertionError | TypeError | LookupError) else first_line(error)
    found, expected = _MENDS.get(first_line(error), (told, "a ROS bag or an MCAP file"))
    return InputError(str(path), "", found, expected)


def _refuse_odd_files(path: Path) -> None:
    """Check what the library opens without limits: its files, the table of contents, compression of messages.

    Raises:
        InputError: A file is no regular one, or may not be read.
    """
    expected = "a ROS bag or an MCAP file"
    if not path.is_dir():
        read_head(path, expected)
        return
    known = path / "metadata.yaml"
    contents = load_mapping(read_text(known, expected), str(known)) if known.exists() else {}
    about = contents.get("rosbag2_bagfile_information")
    if isinstance(about, dict) and str(about.get("compression_mode", "")).lower() == "message":
        raise InputError(str(path), "compression_mode", "message", "a bag without it (`ros2 bag convert`)")
    for file in path.iterdir():
        if file.suffix == ".db3":
            check_tables(file, "messages", "topics")
        elif not file.is_dir():
            read_head(file, expected)


def _remember_definitions(anyreader: Any) -> None:
    """Make the library parse each text that defines messages once: a map opens its recording a dozen times."""
    if not hasattr(anyreader.get_types_from_msg, "cache_info"):
        anyreader.get_types_from_msg = lru_cache(maxsize=256)(anyreader.get_types_from_msg)


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
