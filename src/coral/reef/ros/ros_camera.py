"""A camera that speaks ROS 2: sensor_msgs/Image or CompressedImage, with the CameraInfo beside it if there is one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.ros.camera_info import camera_of, info_topic
from coral.reef.sea.picture import Shot
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.camera_pictures import colours_in
from coral.ros.ros_node import Newest, RosNode, ros_type

FIRST_S, NEXT_S = 10.0, 1.0
"""Longest wait for the first picture, and for any other at a time."""
OFF_DEG = 3.0
"""A lens that differs by more from the configured one is told."""


class RosCamera:
    """Keeps the newest picture of a topic; one that ends with /compressed holds compressed pictures.

    `latency_s` is the time from the light to the message's stamp, as calibrated. `fit` makes a picture one of `camera`,
    with which the robot reckons, or raises ValueError. If the CameraInfo states another lens, pictures are refused;
    where `camera` is of a camera file, that is only told in the name. `place` is the vehicle's namespace, or the file
    of ROS parameters that says whose clock holds.

    Raises:
        InputError: There is no ROS 2, no picture comes, or one of another camera.
    """

    def __init__(
        self,
        topic: str,
        latency_s: float,
        fit: Callable[[NDArray[np.uint8]], NDArray[np.uint8]],
        camera: CameraCfg,
        place: str = "",
        *,
        from_file: bool = False,
        node: RosNode | None = None,
    ) -> None:
        self._topic, self._size, self._about = topic, "", ""
        self._latency_s, self._fit, self._camera, self._from_file = latency_s, fit, camera, from_file
        self._lens_fault = ""
        self._ros = ros = node or RosNode("coral_camera", place, "--camera")
        self._newest = Newest(ros)
        kind = "CompressedImage" if topic.endswith("/compressed") else "Image"
        ros.node.create_subscription(ros_type(f"sensor_msgs.msg.{kind}"), topic, self._newest.hear, ros.qos("sensor"))
        info = ros_type("sensor_msgs.msg.CameraInfo")
        ros.node.create_subscription(info, info_topic(topic), self._hear_lens, ros.qos("sensor"))
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
        self._size = f", {width}x{height}"

    @property
    def name(self) -> str:
        """Topic, size of the pictures and what is known of the lens."""
        return f"ros2:{self._topic}{self._size}{self._about}"

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
        return Shot(stamp_s=stamp_s - self._latency_s, rgb=self._fit(colours_in(message, self._topic)))

    def _hear_lens(self, message: Any) -> None:
        """Compare the lens that the camera states with the one that the robot reckons with."""
        known = self._camera
        try:
            stated = camera_of(message, self._topic, known)
        except InputError as error:
            self._lens_fault = "" if self._from_file else f"{error}: give --lens"
            return
        if stated is None:
            self._about = "" if self._from_file else ", not calibrated: no lens in camera_info"
            return
        told = f"camera_info says {stated.view.hfov_deg:.0f}° across, "
        differs = abs(stated.view.hfov_deg - known.hfov_deg) > OFF_DEG
        if self._from_file:
            self._about = f", {told}the camera file {known.hfov_deg:.0f}°, which counts" if differs else ""
        elif differs:
            self._lens_fault = f"{told}the configuration {known.hfov_deg:.0f}°: give --lens"
        else:
            self._about = ", lens of camera_info" if stated.view == known else ""
