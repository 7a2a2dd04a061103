"""Ranges that speak ROS 2: a cloud of points, or a depth picture with its CameraInfo, as the map's range images.

TOPIC                     sensor_msgs/PointCloud2, or sensor_msgs/Image or CompressedImage with depths
(beside it) camera_info   sensor_msgs/CameraInfo, for depths
/tf, /tf_static           tf2_msgs/TFMessage: where in the vehicle the sensor is, unless its frame is the vehicle's
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.lens import Lens
from coral.reef.map.sonar_3d15 import SonarCfg, sonar_attitude
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.recordings.point_clouds import points_in, range_image_of
from coral.reef.ros.heard_tree import BODY, HeardTree
from coral.reef.ros.newest import Newest
from coral.reef.vehicle.sensing import HeardImage
from coral.ros.camera_lens import lens_of
from coral.ros.camera_pictures import values_in
from coral.ros.ros_node import RosNode, beside, ros_type

FIRST_S, NEXT_S = 10.0, 0.2
"""Longest wait for somebody who publishes the topic, and for any message."""
SEEN = 0.8
"""Share of the configured field of view in which points must have been."""
CLOUD, PICTURES = "sensor_msgs.msg.PointCloud2", ("sensor_msgs.msg.Image", "sensor_msgs.msg.CompressedImage")


class RosSonar:
    """Keeps the newest ranges of a topic, as images with the beams and the tilt of a sonar.

    `place` is the vehicle's namespace, or the file of ROS parameters that says whose clock holds.

    Raises:
        InputError: There is no ROS 2, or nobody publishes ranges there.
    """

    def __init__(self, topic: str, sonar: SonarCfg, place: str = "", node: RosNode | None = None) -> None:
        self._topic, self._sonar = topic, sonar
        self._lens: Lens | None = None
        self._widest = np.zeros(2)
        self._turned = sonar_attitude(0.0, 0.0, 0.0, sonar.pitch_down_deg)
        self._ros = ros = node or RosNode("coral_sonar", place, "--sonar")
        self._newest = Newest(ros)
        kind = self._kind()
        self.name = f"ros2:{topic} ({kind.rpartition('.')[2]})"
        create, sensor = ros.node.create_subscription, ros.qos("sensor")
        if kind != CLOUD:
            info = beside(topic.removesuffix("/compressedDepth"), "camera_info")
            create(ros_type("sensor_msgs.msg.CameraInfo", "--sonar"), info, self._hear_lens, sensor)
        self._tree = HeardTree(ros, "--sonar")
        self._points: Callable[[Any], NDArray[np.float64]] = (
            partial(points_in, where=topic) if kind == CLOUD else self._depths
        )
        create(ros_type(kind, "--sonar"), topic, self._newest.hear, sensor)

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
            points = self._points(message)
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

    def _kind(self) -> str:
        """Wait for the type of the topic."""
        end, whole = time.monotonic() + FIRST_S, self._ros.node.resolve_topic_name(self._topic)
        while True:
            kinds = dict(self._ros.node.get_topic_names_and_types()).get(whole, [])
            found = [name.replace("/", ".") for name in kinds]
            if found or time.monotonic() > end:
                break
            time.sleep(0.1)
        for kind in found:
            if kind == CLOUD or kind in PICTURES:
                return str(kind)
        self._ros.close()
        told = f"{', '.join(kinds)} on {self._topic}" if found else f"nobody publishes {self._topic}"
        raise InputError("--sonar", "", told, "a topic with PointCloud2, or with depth pictures")

    def _depths(self, message: Any) -> NDArray[np.float64]:
        """Return the points of a depth picture in its optical frame: 32FC1 in m, 16UC1 in mm (REP-118)."""
        lens = self._lens
        if lens is None or min(lens.fx, lens.fy) <= 0.0:
            raise UnfitMeasurement("no camera_info", f"beside {self._topic}")
        depths = values_in(message, self._topic, "depth")
        step = max(1, depths.shape[1] // (2 * self._sonar.width))
        z = depths[::step, ::step].astype(np.float64) * (1e-3 if depths.dtype.kind == "u" else 1.0)
        v, u = np.mgrid[: z.shape[0], : z.shape[1]] * float(step)
        points = np.stack([(u - lens.cx) / lens.fx * z, (v - lens.cy) / lens.fy * z, z], axis=-1)
        return points[np.isfinite(z) & (z > 0.0)]

    def _hear_lens(self, message: Any) -> None:
        self._lens = lens_of(message, self._topic)
