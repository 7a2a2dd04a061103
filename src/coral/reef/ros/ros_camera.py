"""A camera that speaks ROS 2: sensor_msgs/Image or CompressedImage, with the CameraInfo beside it if there is one."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.camera_pictures import colours_in
from coral.errors import InputError
from coral.reef.ros.newest import Newest
from coral.reef.sea.picture import Shot
from coral.reef.vehicle.camera import CameraCfg
from coral.ros_node import RosNode, beside, ros_type

FIRST_S, NEXT_S = 10.0, 1.0
"""Longest wait for the first picture, and for any other at a time."""
OFF_DEG = 3.0
"""A lens that differs by more from the configured one is told."""


class RosCamera:
    """Keeps the newest picture of a topic; one that ends with /compressed holds compressed pictures.

    `latency_s` is the time from the light to the message's stamp, as calibrated. `fit` makes a picture one of the
    camera that the robot reckons with, or raises ValueError; `camera` is None if `fit` knows the lens from a camera
    file. `place` is the vehicle's namespace, or the file of ROS parameters that says whose clock holds.

    Raises:
        InputError: There is no ROS 2, no picture comes, or one of another camera.
    """

    labelled = False

    def __init__(
        self,
        topic: str,
        latency_s: float,
        fit: Callable[[NDArray[np.uint8]], NDArray[np.uint8]],
        camera: CameraCfg | None,
        place: str = "",
        node: RosNode | None = None,
    ) -> None:
        self.name = f"ros2:{topic}"
        self._latency_s, self._fit, self._camera = latency_s, fit, camera
        self._lens_fault = ""
        self._ros = ros = node or RosNode("coral_camera", place, "--camera")
        self._newest = Newest(ros)
        kind = "CompressedImage" if topic.endswith("/compressed") else "Image"
        ros.node.create_subscription(ros_type(f"sensor_msgs.msg.{kind}"), topic, self._newest.hear, ros.qos("sensor"))
        info = beside(topic.removesuffix("/compressed"), "camera_info")
        ros.node.create_subscription(ros_type("sensor_msgs.msg.CameraInfo"), info, self._hear_lens, ros.qos("sensor"))
        first = self._newest.take(FIRST_S)
        if first is None:
            ros.close()
            raise InputError("--camera", "", f"no picture on {topic} in {FIRST_S:g} s", "a topic with pictures")
        try:
            height, width = colours_in(first[1], topic).shape[:2]
            self._shot(*first)
        except ValueError as error:
            ros.close()
            raise InputError("--camera", "", f"{topic}: {error}", "pictures of the camera as configured") from None
        self.name += f", {width}x{height}"

    def read(self) -> Shot | None:
        """Wait for the next picture; None when there is none this time.

        Raises:
            ValueError: It is no picture, or of another camera.
        """
        if self._lens_fault:
            raise ValueError(self._lens_fault)
        found = self._newest.take(NEXT_S)
        if found is None:
            raise OSError(f"no picture for {NEXT_S:g} s")
        return self._shot(*found)

    def close(self) -> None:
        """End the node."""
        self._ros.close()

    def _shot(self, stamp_s: float, message: Any) -> Shot:
        return Shot(stamp_s=stamp_s - self._latency_s, rgb=self._fit(colours_in(message, self.name)))

    def _hear_lens(self, message: Any) -> None:
        """Compare the lens that the camera states with the configured one."""
        focal_px, width = float(message.k[0]), int(message.width)
        if self._camera is None or focal_px <= 0.0 or width <= 0:
            return
        stated = math.degrees(2.0 * math.atan(0.5 * width / focal_px))
        known = self._camera.hfov_deg
        if abs(stated - known) > OFF_DEG:
            self._lens_fault = f"camera_info says {stated:.0f}° across, the configuration {known:.0f}°: give --lens"
