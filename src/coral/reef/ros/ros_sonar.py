"""Ranges that speak ROS 2: clouds of points as the map's range images.

TOPIC             sensor_msgs/PointCloud2
/tf, /tf_static   tf2_msgs/TFMessage: where in the vehicle the sensor is, unless its frame is the vehicle's
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.map.sonar_3d15 import SonarCfg, sonar_attitude
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.ros.heard_tree import BODY, HeardTree
from coral.reef.ros.point_clouds import points_in, range_image_of
from coral.reef.vehicle.sensing import HeardImage
from coral.ros.ros_node import Newest, RosNode, ros_type

FIRST_S, NEXT_S = 10.0, 0.2
"""Longest wait for somebody who publishes the topic, and for any message."""
SEEN = 0.8
"""Share of the configured field of view in which points must have been."""
CLOUD = "sensor_msgs/msg/PointCloud2"


class RosSonar:
    """Keeps the newest ranges of a topic, as images with the beams and the tilt of a sonar.

    `place` is the vehicle's namespace, or the file of ROS parameters that says whose clock holds.

    Raises:
        InputError: There is no ROS 2, or nobody publishes ranges there.
    """

    def __init__(self, topic: str, sonar: SonarCfg, place: str = "", node: RosNode | None = None) -> None:
        self._topic, self._sonar = topic, sonar
        self._widest = np.zeros(2)
        self._turned = sonar_attitude(0.0, 0.0, 0.0, sonar.pitch_down_deg)
        self._ros = ros = node or RosNode("coral_sonar", place, "--sonar")
        self._newest = Newest(ros)
        self._await_clouds()
        self.name = f"ros2:{topic} (PointCloud2)"
        self._tree = HeardTree(ros, "--sonar")
        cloud = ros_type("sensor_msgs.msg.PointCloud2", "--sonar")
        ros.node.create_subscription(cloud, topic, self._newest.hear, ros.qos("sensor"))

    def read(self) -> HeardImage | None:
        """Wait for the next ranges; None when there are none this time.

        Raises:
            UnfitMeasurement: They cannot be read, or nobody knows where in the vehicle the sensor is.
        """
        found = self._newest.take(NEXT_S)
        if found is None:
            return None
        stamp_s, message = found
        try:
            points = points_in(message, self._topic)
        except InputError as error:
            raise UnfitMeasurement("unreadable", str(error)) from None
        frame = str(message.header.frame_id)
        mount = self._tree.in_vehicle(frame)
        if mount is None:
            why = f"; {self._tree.missing}" if self._tree.missing else ""
            raise UnfitMeasurement("no transform", f"from {BODY} to {frame!r} on /tf_static{why}")
        points = (points @ mount[:3, :3].T + mount[:3, 3]) @ self._turned
        self._check_view(points)
        return HeardImage(stamp_s, range_image_of(points, self._sonar))

    def close(self) -> None:
        """End the node."""
        self._ros.close()

    def _check_view(self, points: NDArray[np.float64]) -> None:
        """Refuse a sensor that does not look as wide as the map reckons: beams that it lacks would count as clear."""
        sonar, level = self._sonar, np.hypot(points[:, 0], points[:, 1])
        sides, heights = np.arctan2(points[:, 1], points[:, 0]), np.arctan2(points[:, 2], level)
        found = [2.0 * float(np.degrees(np.abs(each).max(initial=0.0))) for each in (sides, heights)]
        self._widest = np.maximum(self._widest, found)
        wanted = np.array([sonar.hfov_deg, sonar.vfov_deg])
        if (self._widest < SEEN * wanted).any():
            told = [f"{each[0]:.0f} by {each[1]:.0f} degrees" for each in (self._widest, wanted)]
            where = "--cfg.simulator.sonar.hfov-deg and .vfov-deg"
            raise UnfitMeasurement("narrow", f"points in {told[0]}, the configured sonar has {told[1]}: set {where}")

    def _await_clouds(self) -> None:
        """Wait until somebody publishes the topic.

        Raises:
            InputError: Nobody does, or it has another type.
        """
        end, whole = time.monotonic() + FIRST_S, self._ros.node.resolve_topic_name(self._topic)
        while not (kinds := dict(self._ros.node.get_topic_names_and_types()).get(whole, [])):
            if time.monotonic() > end:
                break
            time.sleep(0.1)
        if CLOUD not in kinds:
            self._ros.close()
            told = f"{', '.join(kinds)} on {self._topic}" if kinds else f"nobody publishes {self._topic}"
            expected = "a topic with PointCloud2 (of depth pictures: by ROS's depth_image_proc)"
            raise InputError("--sonar", "", told, expected)
