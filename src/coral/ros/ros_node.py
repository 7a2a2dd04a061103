"""A ROS 2 node of this program: rclpy on demand, its callbacks on a thread of their own, stamps on our clock."""

from __future__ import annotations

import contextlib
import importlib
import math
import queue
import threading
import time
from pathlib import Path
from typing import Any

from coral.errors import InputError, first_line, install_extra

OLDEST_S, NEWEST_S = 10.0, 0.5
"""A stamp older than this, or further ahead of the clock, is of another clock."""
OLD_S = 60.0
"""What is of another clock counts as this old."""


class OtherClockError(ValueError):
    """A stamp is of another clock than ours."""


def ros_type(name: str, flag: str = "--vehicle") -> Any:
    """Import a type of message or service, such as `nav_msgs.msg.Odometry`.

    Raises:
        InputError: ROS 2 is not there; the error names the flag that asked for it.
    """
    module, _, kind = name.rpartition(".")
    try:
        return getattr(importlib.import_module(module), kind)
    except ImportError as error:
        wanted = f"ROS 2: source its setup.bash in this terminal, or {install_extra('ros2')}"
        raise InputError(flag, "", f"no {module.partition('.')[0]} ({first_line(error)})", wanted) from None


def ros_words(place: str, flag: str) -> list[str]:
    """Return what ROS calls arguments, for the namespace and the files of parameters of a node.

    Raises:
        InputError: There is no such file.
    """
    words = []
    for each in filter(None, place.split(",")):
        if not each.endswith((".yaml", ".yml")):
            words += ["-r", f"__ns:=/{each.strip('/')}"]
        elif Path(each).is_file():
            words += ["--params-file", each]
        else:
            raise InputError(flag, "", f"ros2:{each}", "a file of ROS parameters, or a namespace")
    return ["--ros-args", *words] if words else []


class RosNode:
    """A node with a thread that runs its callbacks.

    Args:
        name: Of the node.
        place: A namespace such as /bluerov2, a file of ROS parameters (.yaml), in which `use_sim_time` and the names of
            topics may stand, or several of these with commas between; "" for none. The last file counts.
        flag: Flag to name in an error.

    Raises:
        InputError: There is no ROS 2, or it does not accept `place`.
    """

    def __init__(self, name: str, place: str, flag: str) -> None:
        context = self.context = ros_type("rclpy.context.Context", flag)()
        self._rclpy, self._executors = importlib.import_module("rclpy"), importlib.import_module("rclpy.executors")
        try:
            self._rclpy.init(args=ros_words(place, flag), context=context)
            self.node = self._rclpy.create_node(
                name, context=context, automatically_declare_parameters_from_overrides=True
            )
        except Exception as error:  # rclpy raises what its C library says, of many types
            raise InputError(flag, "", f"ros2:{place}", f"what ROS 2 accepts: {first_line(error)}") from None
        self._executor = self._executors.SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)
        self._thread.start()

    def parameter(self, name: str, default: str) -> str:
        """Return the text of a parameter of the node."""
        return str(self.node.get_parameter(name).value) if self.node.has_parameter(name) else default

    def monotonic(self, stamp: Any) -> float:
        """Convert a message's stamp to monotonic time (s). A stamp of zero is the time of arrival.

        Raises:
            OtherClockError: It is too far from this node's clock.
        """
        sent_s, now = stamp.sec + 1e-9 * stamp.nanosec, time.monotonic()
        if sent_s == 0.0:
            return now
        age_s = 1e-9 * self.node.get_clock().now().nanoseconds - sent_s
        if not -NEWEST_S < age_s < OLDEST_S or not math.isfinite(age_s):
            raise OtherClockError(f"stamps are {age_s:+.1f} s behind this clock: synchronise clocks, or use_sim_time")
        return float(now - max(age_s, 0.0))

    def stamp(self) -> Any:
        """Return the present time as messages have it."""
        return self.node.get_clock().now().to_msg()

    def qos(self, kind: str) -> Any:
        """Return a quality of service: `sensor` (newest only, may be lost) or `latched` (kept for who comes later)."""
        qos = importlib.import_module("rclpy.qos")
        if kind == "sensor":
            return qos.QoSProfile(depth=1, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
        return qos.QoSProfile(depth=1, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)

    def close(self) -> None:
        """End the thread and the node."""
        self._executor.shutdown(timeout_sec=2.0)
        self._thread.join(2.0)
        self.node.destroy_node()
        self._rclpy.shutdown(context=self.context)

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except Exception:  # of many types, when the context ends first
            if self.context.ok():
                raise


class Newest:
    """The newest message of a topic, with its stamp on our clock; an older one that nobody has taken is dropped."""

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
