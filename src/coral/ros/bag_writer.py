"""Writing a ROS 2 bag or one MCAP file, message by message."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from coral.errors import InputError, install_extra
from coral.file_writer import scratch_for

Numbers = Sequence[float] | NDArray[Any]


class BagWriter:
    """Makes messages of ROS 2 and writes them, in order of time, with an open `Writer` of rosbags.

    `topics` has the type of the messages on each topic, and what they are.
    """

    def __init__(self, writer: Any, topics: Mapping[str, tuple[str, str]]) -> None:
        from rosbags.typesys import Stores, get_typestore

        self._writer, self._store, self._topics = writer, get_typestore(Stores.ROS2_HUMBLE), topics
        self._connections: dict[str, Any] = {}
        self.counts: dict[str, int] = {}
        """Number of messages on each topic that has some."""

    def new(self, kind: str, **values: Any) -> Any:
        """Make a message of a type."""
        return self._store.types[kind](**values)

    def send(self, topic: str, t: float, message: Any) -> None:
        """Write a message at a time (s)."""
        kind, _ = self._topics[topic]
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(topic, kind, typestore=self._store)
        self.counts[topic] = self.counts.get(topic, 0) + 1
        self._writer.write(self._connections[topic], nanoseconds_of(t), self._store.serialize_cdr(message, kind))

    def time(self, t: float) -> Any:
        """Make a Time of a time (s)."""
        seconds, nanoseconds = divmod(nanoseconds_of(t), 1_000_000_000)
        return self.new("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)

    def header(self, t: float, frame_id: str) -> Any:
        """Make a Header."""
        return self.new("std_msgs/msg/Header", stamp=self.time(t), frame_id=frame_id)

    def point(self, xyz: Numbers) -> Any:
        """Make a Point (m)."""
        return self.new("geometry_msgs/msg/Point", **_named("xyz", xyz))

    def vector(self, xyz: Numbers) -> Any:
        """Make a Vector3."""
        return self.new("geometry_msgs/msg/Vector3", **_named("xyz", xyz))

    def quaternion(self, xyzw: Numbers) -> Any:
        """Make a Quaternion; ROS puts the real part last."""
        return self.new("geometry_msgs/msg/Quaternion", **_named("xyzw", xyzw))

    def transform(self, parent: str, child: str, xyz: Numbers, xyzw: Numbers, t: float) -> Any:
        """Make a TransformStamped: where the child stands in the parent."""
        moved = self.new("geometry_msgs/msg/Transform", translation=self.vector(xyz), rotation=self.quaternion(xyzw))
        kind, header = "geometry_msgs/msg/TransformStamped", self.header(t, parent)
        return self.new(kind, header=header, child_frame_id=child, transform=moved)

    def text(self, text: str) -> Any:
        """Make a String."""
        return self.new("std_msgs/msg/String", data=text)


@contextmanager
def open_bag(path: Path, topics: Mapping[str, tuple[str, str]], *, single_file: bool) -> Iterator[BagWriter]:
    """Open a new bag, a folder or a single MCAP file; it stands at its place when it is whole.

    Raises:
        InputError: The path exists, or rosbags is not installed.
    """
    if path.exists():
        raise InputError(str(path), "--out", "something that exists already", "a new path")
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
    except ImportError:
        raise InputError(str(path), "", "no package rosbags", install_extra("bags")) from None
    with scratch_for(path) as scratch:
        folder = scratch.with_name(f"{path.stem}.bag") if single_file else scratch
        with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            yield BagWriter(writer, topics)
        if single_file:
            next(folder.glob("*.mcap")).rename(scratch)


def nanoseconds_of(t: float) -> int:
    """Return a time (s) in whole nanoseconds."""
    return math.floor(t * 1e9 + 0.5)


def _named(names: str, values: Numbers) -> dict[str, float]:
    return {name: float(value) for name, value in zip(names, values, strict=True)}
