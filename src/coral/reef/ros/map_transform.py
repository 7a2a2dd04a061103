"""Where the odometry's frame is in the survey's, on /tf, unless another node says so."""

from __future__ import annotations

import math
import time
from typing import Any

from coral.errors import InputError
from coral.reef.recordings.frame_tree import MAP, frame_name
from coral.reef.world.geometry import Pose
from coral.ros.ros_node import RosNode, ros_type

LISTEN_S = 2.0
"""Others are listened for this long before anything is sent."""


def odometry_in_map(odometry: Pose, pose: Pose) -> Pose:
    """Return the place of the odometry's frame in the map, from one pose in both."""
    turn = pose.theta - odometry.theta
    c, s = math.cos(turn), math.sin(turn)
    return Pose(pose.x - (c * odometry.x - s * odometry.y), pose.y - (s * odometry.x + c * odometry.y), turn)


class MapTransform:
    """Sends the transform from `map` to the frame of the odometry, with what the localizer corrected.

    Another node that tells where this frame is has precedence, and so has the parameter `publish_tf: false`.
    """

    def __init__(self, ros: RosNode) -> None:
        self.told = "not yet"
        """Who sends it, or why nobody does here."""
        self._ros, self._begun_s = ros, time.monotonic()
        self._others: dict[str, str] = {}
        """Parents of frames, as other nodes tell them."""
        self._sent: tuple[Any, ...] = ()
        """Stamps of what was sent last: it is heard, too."""
        if ros.parameter("publish_tf", "true").lower() == "false":
            self.told = "off: publish_tf"
            return
        try:
            self._message = ros_type("tf2_msgs.msg.TFMessage")
        except InputError as error:
            self.told = f"off: {error.found}"
            return
        self._stamped = ros_type("geometry_msgs.msg.TransformStamped")
        self._publisher = ros.node.create_publisher(self._message, "/tf", 10)
        ros.node.create_subscription(self._message, "/tf", self._hear, 100)
        ros.node.create_subscription(self._message, "/tf_static", self._hear, ros.qos("latched"))

    def publish(self, frame: str, odometry: Pose, pose: Pose) -> None:
        """Send the transform, by one pose in the odometry's frame and in the map."""
        if self.told.startswith("off") or time.monotonic() - self._begun_s < LISTEN_S:
            return
        if frame in ("", MAP):
            self.told = f"not needed: the odometry is in {frame!r}"
            return
        if frame in self._others:
            self.told = f"by another node: {self._others[frame]} -> {frame}"
            return
        at, message = odometry_in_map(odometry, pose), self._stamped()
        message.header.stamp = self._ros.stamp()
        message.header.frame_id, message.child_frame_id = MAP, frame
        message.transform.translation.x, message.transform.translation.y = float(at.x), float(at.y)
        message.transform.rotation.z = math.sin(at.theta / 2.0)
        message.transform.rotation.w = math.cos(at.theta / 2.0)
        self._sent = (*self._sent[-49:], message.header.stamp)
        self._publisher.publish(self._message(transforms=[message]))
        self.told = f"{MAP} -> {frame}"

    def _hear(self, message: Any) -> None:
        for each in message.transforms:
            parent = frame_name(str(each.header.frame_id))
            if parent != MAP or each.header.stamp not in self._sent:
                self._others[frame_name(str(each.child_frame_id))] = parent
