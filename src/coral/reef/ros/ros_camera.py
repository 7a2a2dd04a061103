"""A camera that speaks ROS 2: sensor_msgs/Image or CompressedImage, the CameraInfo beside it, and its tilt on /tf."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.ros.heard_tree import HeardTree
from coral.reef.sea.latest_reading import Shot
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.sea.video_camera import WIDEST_PX, resized
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.camera_pictures import colours_in, lens_of
from coral.ros.ros_node import Newest, RosNode, ros_type

FIRST_S, NEXT_S = 10.0, 1.0
"""Longest wait for the first picture or its CameraInfo, and for any other picture at a time."""
ALONE_S, LOOK_S = 2.0, 0.2
"""Longest wait for a CameraInfo, or for a mount, that nobody publishes; and between two looks."""
LEVEL_DEG = 5.0
"""A camera that looks farther aside, or is rolled by more, is none that the map reckons with."""
OFF_DEG = 3.0
"""A lens that differs by more from the one that the robot reckons with is told."""


class RosCamera:
    """Keeps the newest picture of a topic; one that ends with /compressed holds compressed pictures.

    The lens is that of `known`, of a camera file; else the one that CameraInfo states, in a `mount` whose tilt /tf and
    /tf_static may tell; else `mount` is the camera. If CameraInfo states another one later, pictures are refused; where
    there is a camera file, that is only told in the name.

    Raises:
        InputError: There is no ROS 2, no picture comes, or one of another camera; the lens or the mount cannot be used.
    """

    def __init__(
        self,
        topic: str,
        latency_s: float,
        mount: CameraCfg,
        place: str = "",
        known: RecordedCamera | None = None,
        node: RosNode | None = None,
    ) -> None:
        """Wait for the first picture and its lens.

        `latency_s` is the time from the light to the message's stamp, as calibrated; `place` is the vehicle's
        namespace, or the file of ROS parameters that says whose clock holds.
        """
        self._topic, self._latency_s, self._from_file = topic, latency_s, known is not None
        self._size = self._about = self._lens_fault = ""
        self._ros = ros = node or RosNode("coral_camera", place, "--camera")
        self._newest, self._infos = Newest(ros), Newest(ros)
        kind, sensor = "CompressedImage" if topic.endswith("/compressed") else "Image", ros.qos("sensor")
        ros.node.create_subscription(ros_type(f"sensor_msgs.msg.{kind}", "--camera"), topic, self._newest.hear, sensor)
        info = ros_type("sensor_msgs.msg.CameraInfo", "--camera")
        ros.node.create_subscription(info, info_topic(topic), self._infos.hear, sensor)
        try:
            first = self._newest.take(FIRST_S)
            if first is None:
                raise InputError("--camera", "", f"no picture on {topic} in {FIRST_S:g} s", "a topic with pictures")
            camera = known or self._stated_camera(mount)
            self.view = mount if camera is None else camera.view
            """The camera that its pictures are of, once they fit."""
            self._fit = partial(resized, camera=mount) if camera is None else camera.picture
            self._size = ", {1}x{0}".format(*colours_in(first[1], topic).shape)
            self._shot(*first)
        except ValueError as error:
            ros.close()
            if isinstance(error, InputError):
                raise
            raise InputError("--camera", "", f"{topic}: {error}", "pictures of the camera as configured") from None

    @property
    def name(self) -> str:
        """Topic, size of the pictures and what is known of the lens."""
        return f"ros2:{self._topic}{self._size}{self._about}"

    def read(self) -> Shot | None:
        """Wait for the next picture; None when there is none this time.

        Raises:
            ValueError: It is no picture, or of another camera.
        """
        if (stated := self._infos.take(0.0)) is not None:
            self._compare_lens(stated[1])
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

    def _stated_camera(self, mount: CameraCfg) -> RecordedCamera | None:
        """Wait for the camera that CameraInfo states; None if nobody states one, or it is not calibrated."""
        begun, count = time.monotonic(), self._ros.node.count_publishers
        while (stated := self._infos.take(LOOK_S)) is None:
            spent_s = time.monotonic() - begun
            if spent_s > FIRST_S or (spent_s > ALONE_S and not count(info_topic(self._topic))):
                return None
        camera = camera_of(stated[1], self._topic, self._mounted(mount, str(stated[1].header.frame_id)))
        self._about = ", not calibrated: no lens in camera_info" if camera is None else ", lens of camera_info"
        return camera

    def _mounted(self, mount: CameraCfg, frame: str) -> CameraCfg:
        """Return a mount with the tilt that the tree of frames tells; as it is where that does not know the camera."""
        begun, tree = time.monotonic(), HeardTree(self._ros, "--camera")
        while (found := tree.in_vehicle(frame)) is None:
            spent_s = time.monotonic() - begun
            if spent_s > ALONE_S or (spent_s > 0.3 * ALONE_S and not self._ros.node.count_publishers("/tf_static")):
                return mount
            time.sleep(0.1 * LOOK_S)
        return tilted(mount, found[:3, :3], frame)

    def _compare_lens(self, message: Any) -> None:
        """Compare the lens that the camera states now with the one that the robot reckons with."""
        known = self.view
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


def info_topic(topic: str) -> str:
    """Return the topic of the CameraInfo that belongs to pictures: beside theirs."""
    head, slash, _ = topic.removesuffix("/compressed").rpartition("/")
    return f"{head}{slash}camera_info"


def camera_of(message: Any, topic: str, mount: CameraCfg) -> RecordedCamera | None:
    """Return the camera that a CameraInfo states, mounted like another one; None if it is not calibrated.

    Raises:
        InputError: Its lens cannot be used.
    """
    lens = lens_of(message, topic)
    uncalibrated = lens.fx == 0.0 or min(lens.width, lens.height) <= 0
    return None if uncalibrated else RecordedCamera.of(lens, mount, info_topic(topic), WIDEST_PX)


def tilted(mount: CameraCfg, turn: NDArray[np.float64], frame: str) -> CameraCfg:
    """Return a mount with the tilt of an optical frame (x right, y down, z ahead, REP-103) in the vehicle.

    `turn` is the rotation from the optical frame to the vehicle's. Shape=(3, 3).

    Raises:
        InputError: The camera looks aside, or is rolled.
    """
    right, _, ahead = turn.T
    aside, roll = math.degrees(math.atan2(right[0], -right[1])), math.degrees(math.asin(np.clip(right[2], -1.0, 1.0)))
    if max(abs(aside), abs(roll)) > LEVEL_DEG:
        found = f"turned by {aside:.0f} degrees to the left and rolled by {roll:.0f} degrees on /tf"
        expected = "an optical frame (REP-103) of a camera that looks ahead or down; or state pitch_down_deg by --lens"
        raise InputError("--camera", f"frame {frame!r}", found, expected)
    down = math.degrees(math.atan2(-ahead[2], math.hypot(ahead[0], ahead[1])))
    return replace(mount, pitch_down_deg=round(down, 2))
