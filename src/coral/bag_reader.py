"""Messages of a ROS 2 bag or an MCAP file, with one line for what is wrong in it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from coral.errors import InputError, first_line

FILES = (".mcap", ".db3", ".bag")
"""MCAP, SQLite of ROS 2, and ROS 1."""
_MENDS = {
    "File end magic is invalid.": (
        "a file without an end, unfinished or cut",
        "a whole one: `mcap recover FILE -o OUT`",
    ),
    "Profile is not ros2.": ("an MCAP file of other messages", "messages of ROS 2 (profile ros2)"),
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


def count_messages(path: Path) -> dict[str, int]:
    """Return the number of messages on each topic.

    Raises:
        InputError: It is no bag, or rosbags is not installed.
    """
    with _opened(path) as reader:
        return {one.topic: one.msgcount for one in reader.connections}


def message_types(path: Path) -> dict[str, str]:
    """Return the type of the messages on each topic.

    Raises:
        InputError: It is no bag, or rosbags is not installed.
    """
    with _opened(path) as reader:
        return {one.topic: one.msgtype for one in reader.connections}


def read_messages(path: Path, wanted: set[str]) -> Iterator[tuple[str, Any]]:
    """Return topic and message of all messages on some topics, in order of time, one after the other.

    Raises:
        InputError: It is no bag, a message is damaged, or rosbags is not installed.
    """
    with _opened(path) as reader:
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
        except Exception as error:
            if type(error).__module__.startswith("rosbags"):
                raise InputError(str(path), "", first_line(error), "a whole file") from None
            raise


def stamp_of(message: Any) -> float:
    """Return the time of a message's header (s)."""
    stamp = message.header.stamp
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(
            str(path), "", "no package rosbags", "the extra bags: pip install 'coral-robotics[bags]'"
        ) from None
    try:
        reader = AnyReader(_loose_files(path) or [path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
        reader.open()
    except (AnyReaderError, OSError, ValueError, AssertionError, AttributeError, KeyError, EOFError) as error:
        raise _cannot_open(path, error) from None
    except Exception as error:
        if type(error).__module__.startswith("rosbags"):
            raise _cannot_open(path, error) from None
        raise
    try:
        yield reader
    finally:
        reader.close()


def _cannot_open(path: Path, error: Exception) -> InputError:
    found, expected = _MENDS.get(first_line(error), (first_line(error), "a ROS bag or an MCAP file"))
    return InputError(str(path), "", found, expected)
