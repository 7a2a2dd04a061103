"""The objects' poses from ROS 2 topics, passed on as the datagrams that every tracker sends."""

from __future__ import annotations

import socket
from collections.abc import Iterable
from functools import partial
from typing import Any

import numpy as np

from coral.contact.franka.object_poses import poses_datagram
from coral.contact.franka.ros_topics import topic
from coral.contact.scene.observation import Array, BodyState
from coral.ros.ros_node import RosNode, ros_type

FLAG = "--robot"


class RosPoses:
    """Hears `geometry_msgs/PoseStamped`, one topic for each object, and `vision_msgs/Detection3DArray` where asked.

    A pose is in the frame `world`, in the arm's base (a frame whose name ends with `link0` or `base`) or in the tool's
    (`tcp`); of another frame it is ignored, and so is one whose stamp is not newer than the last.

    The arm's foot, `base_m`, is in the world frame. Datagrams are heard at `address`.

    Raises:
        InputError: A type of message is missing.
    """

    def __init__(self, ros: RosNode, names: Iterable[str], base_m: Array, address: tuple[str, int]) -> None:
        self._names, self._base, self._address = tuple(names), np.asarray(base_m, float), address
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._newest: dict[str, float] = {}
        for name in self._names:
            posed, where = ros_type("geometry_msgs.msg.PoseStamped", FLAG), topic(ros, "poses.NAME", name)
            ros.node.create_subscription(posed, where, partial(self._hear, name), ros.qos("sensor"))
        if where := topic(ros, "detections"):
            detected = ros_type("vision_msgs.msg.Detection3DArray", FLAG)
            ros.node.create_subscription(detected, where, self._hear_detections, ros.qos("sensor"))

    def close(self) -> None:
        """Send no more datagrams."""
        self._socket.close()

    def _hear(self, name: str, message: Any) -> None:
        self._send(name, message.header, message.pose)

    def _hear_detections(self, message: Any) -> None:
        """Take the likeliest hypothesis of each detection; its class, or else the detection's id, is the object."""
        for detection in message.detections:
            if not detection.results:
                continue
            best = max(detection.results, key=lambda result: float(result.hypothesis.score))
            for name in (str(best.hypothesis.class_id), str(detection.id)):
                if name in self._names:
                    self._send(name, message.header, best.pose.pose)
                    break

    def _send(self, name: str, header: Any, pose: Any) -> None:
        stamp_s, frame = stamp_seconds(header.stamp), str(header.frame_id)
        if stamp_s <= self._newest.get(name, -1.0):
            return
        position, quaternion = pose_arrays(pose)
        if frame.endswith(("link0", "base")):
            position = position + self._base
        elif frame != "world" and not frame.endswith("tcp"):
            return
        self._newest[name] = stamp_s
        held = (name,) if frame.endswith("tcp") else ()
        self._socket.sendto(poses_datagram({name: BodyState(position, quaternion)}, held), self._address)


def stamp_seconds(stamp: Any) -> float:
    """Return a stamp in seconds."""
    return float(stamp.sec + 1e-9 * stamp.nanosec)


def pose_arrays(pose: Any) -> tuple[Array, Array]:
    """Return position (m) and quaternion (w, x, y, z) of a `geometry_msgs/Pose`."""
    at, q = pose.position, pose.orientation
    return np.array([at.x, at.y, at.z]), np.array([q.w, q.x, q.y, q.z])
