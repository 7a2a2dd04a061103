"""The lens that a camera states in the sensor_msgs/CameraInfo beside its pictures."""

from __future__ import annotations

import math
import queue
import time
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.ros.heard_tree import HeardTree
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.sea.video_camera import WIDEST_PX
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.camera_pictures import lens_of
from coral.ros.ros_node import RosNode, beside, ros_type

FIRST_S, ALONE_S, LOOK_S = 10.0, 2.0, 0.2
"""Longest wait for a CameraInfo; for one whose topic nobody publishes, beside pictures; and between two looks."""
LEVEL_DEG = 5.0
"""A camera that looks farther aside, or is rolled by more, is none that the map reckons with."""


def info_topic(topic: str) -> str:
    """Return the topic of the CameraInfo that belongs to pictures."""
    return beside(topic.removesuffix("/compressed"), "camera_info")


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


def _mounted(mount: CameraCfg, frame: str, tree: HeardTree, ros: RosNode) -> CameraCfg:
    """Return a mount with the tilt that the tree of frames tells; as it is where the tree does not know the camera."""
    begun = time.monotonic()
    while (found := tree.in_vehicle(frame)) is None:
        spent_s = time.monotonic() - begun
        if spent_s > ALONE_S or (spent_s > 0.3 * ALONE_S and not ros.node.count_publishers("/tf_static")):
            break
        time.sleep(0.1 * LOOK_S)
    return mount if found is None else tilted(mount, found[:3, :3], frame)


def stated_camera(topic: str, mount: CameraCfg, place: str = "", node: RosNode | None = None) -> RecordedCamera | None:
    """Return the camera that is stated beside a topic of pictures, as it is mounted; None if there is no lens of it.

    Args:
        topic: Of the pictures.
        mount: Its height and range count, and its tilt where /tf and /tf_static do not tell the camera's.
        place: The vehicle's namespace, or a file of ROS parameters.
        node: Node to listen with; by default one of its own.

    Raises:
        InputError: There is no ROS 2, nobody publishes pictures there, or the lens or the mount cannot be used.
    """
    ros = node or RosNode("coral_camera_info", place, "--camera")
    heard: queue.SimpleQueue[Any] = queue.SimpleQueue()
    info, tree = info_topic(topic), HeardTree(ros, "--camera")
    try:
        ros.node.create_subscription(
            ros_type("sensor_msgs.msg.CameraInfo", "--camera"), info, heard.put, ros.qos("sensor")
        )
        begun, pictures_s = time.monotonic(), None
        while (spent_s := time.monotonic() - begun) <= FIRST_S:
            try:
                message = heard.get(timeout=LOOK_S)
                return camera_of(message, topic, _mounted(mount, str(message.header.frame_id), tree, ros))
            except queue.Empty:
                pass
            if pictures_s is None and ros.node.count_publishers(topic):
                pictures_s = spent_s
            if pictures_s is not None and spent_s - pictures_s > ALONE_S and not ros.node.count_publishers(info):
                return None
        if pictures_s is None:
            raise InputError("--camera", "", f"no picture on {topic} in {FIRST_S:g} s", "a topic with pictures")
        return None
    finally:
        ros.close()
