"""A reef run as a ROS 2 bag: pictures, odometry, transforms, maps (REP-103, REP-105).

Frames: map -> odom -> base_link -> camera_optical. odom is where odometry alone puts the vehicle; map -> odom is what
the robot's own localization corrects. The origin of z is the sea floor.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.drawing import jpeg, png
from coral.reef.eyes.doubt import pack_doubt
from coral.reef.map.mapping import FREE, OBSTACLE, TARGET, OccupancyMap
from coral.reef.recordings.recorded_pictures import encode_depth
from coral.reef.recordings.recording import RECORDED, PosedFrame, Recording
from coral.reef.recordings.transforms import body_transform, camera_in_body, quaternion_of
from coral.ros.bag_writer import BagWriter, open_bag

TOPICS = {
    "/camera/image/compressed": ("sensor_msgs/msg/CompressedImage", "Colour, if the run took it."),
    "/camera/depth/compressed": ("sensor_msgs/msg/CompressedImage", "PNG without loss."),
    "/camera/classes/compressed": ("sensor_msgs/msg/CompressedImage", "PNG without loss."),
    "/camera/doubt/compressed": (
        "sensor_msgs/msg/CompressedImage",
        "Doubt of classes in steps of 1/255, where a network saw the pictures.",
    ),
    "/camera/seen_by": ("std_msgs/msg/String", "What found classes and depth, if known: `exact`, `rgb` or a file."),
    "/camera/camera_info": ("sensor_msgs/msg/CameraInfo", "The camera."),
    "/odometry": ("nav_msgs/msg/Odometry", "`odom` to `base_link`, by odometry alone."),
    "/tf": ("tf2_msgs/msg/TFMessage", "`map` to `odom` (what localization corrects), `odom` to `base_link`."),
    "/tf_static": ("tf2_msgs/msg/TFMessage", "`base_link` to `camera_optical`."),
    "/map": ("nav_msgs/msg/OccupancyGrid", "Every 20 s and at the end, made from the kept pictures."),
    "/oysters": ("nav_msgs/msg/OccupancyGrid", "The same, of oysters."),
}
"""Type of each topic, and what is on it."""
MAP_EVERY_S = 20.0


def write_bag(recording: Recording, path: Path, *, single_file: bool) -> dict[str, int]:
    """Write a located recording as a folder or one MCAP file. Return the number of messages on each topic with some.

    Raises:
        InputError: The path exists, or rosbags is not installed.
    """
    with open_bag(path, TOPICS, single_file=single_file) as bag:
        _SurveyWriter(bag).write(recording)
    return bag.counts


export_mcap = partial(write_bag, single_file=True)
"""One MCAP file, for Foxglove and every reader of MCAP."""
export_bag = partial(write_bag, single_file=False)
"""A ROS 2 bag (`ros2 bag info`, `ros2 bag play`): a folder with MCAP storage."""


class _SurveyWriter:
    """Turns keyframes into messages."""

    def __init__(self, bag: BagWriter) -> None:
        self._bag = bag
        self._new, self._send, self._header = bag.new, bag.send, bag.header

    def write(self, recording: Recording) -> None:
        cells = OccupancyMap(recording.size_m, recording.camera, recording.map)
        map_due = 0.0
        static = self._transform("base_link", "camera_optical", camera_in_body(recording.camera), 0.0)
        t = 0.0
        for number, keyframe in enumerate(recording.keyframes()):
            t = keyframe.t
            if number == 0:
                self._send("/tf_static", t, self._new("tf2_msgs/msg/TFMessage", transforms=[static]))
                if recording.seen_by != RECORDED:
                    self._send("/camera/seen_by", t, self._bag.text(recording.seen_by))
            self._send("/camera/camera_info", t, self._camera_info(recording, t))
            self._pose(keyframe)
            self._pictures(keyframe)
            cells.integrate(keyframe.frame, keyframe.pose, keyframe.roll, keyframe.pitch)
            if t >= map_due - 1e-9:
                map_due = t + MAP_EVERY_S
                self._maps(cells, t)
        self._maps(cells, t)

    def _pose(self, keyframe: PosedFrame) -> None:
        t = keyframe.t
        at = body_transform(keyframe.pose, keyframe.height_m, keyframe.roll, keyframe.pitch)
        odometry = keyframe.odometry or keyframe.pose
        by_odometry = body_transform(odometry, keyframe.height_m, keyframe.roll, keyframe.pitch)
        correction = np.eye(4) if odometry == keyframe.pose else at @ np.linalg.inv(by_odometry)
        transforms = [
            self._transform("map", "odom", correction, t),
            self._transform("odom", "base_link", by_odometry, t),
        ]
        # Transforms first: who reads in order knows the correction when the odometry comes.
        self._send("/tf", t, self._new("tf2_msgs/msg/TFMessage", transforms=transforms))
        pose = self._new(
            "geometry_msgs/msg/Pose",
            position=self._bag.point(by_odometry[:3, 3]),
            orientation=self._bag.quaternion(quaternion_of(by_odometry[:3, :3])),
        )
        zero = self._bag.vector((0.0, 0.0, 0.0))
        unknown = np.zeros(36)
        message = self._new(
            "nav_msgs/msg/Odometry",
            header=self._header(t, "odom"),
            child_frame_id="base_link",
            pose=self._new("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=unknown),
            twist=self._new(
                "geometry_msgs/msg/TwistWithCovariance",
                twist=self._new("geometry_msgs/msg/Twist", linear=zero, angular=zero),
                covariance=np.r_[-1.0, np.zeros(35)],  # by convention: no velocity is given
            ),
        )
        self._send("/odometry", t, message)

    def _pictures(self, keyframe: PosedFrame) -> None:
        frame, t = keyframe.frame, keyframe.t
        pictures = [
            ("/camera/depth/compressed", "16UC1; png compressed", png(encode_depth(frame.depth))),
            ("/camera/classes/compressed", "mono8; png compressed", png(frame.labels)),
        ]
        if frame.rgb is not None:
            pictures.append(("/camera/image/compressed", "rgb8; jpeg compressed bgr8", jpeg(frame.rgb)))
        if frame.doubt is not None:
            doubt = png(pack_doubt(frame.doubt))
            pictures.append(("/camera/doubt/compressed", "mono8; png compressed", doubt))
        for topic, kind, content in pictures:
            self._picture(topic, kind, content, t)

    def _picture(self, topic: str, kind: str, content: bytes, t: float) -> None:
        data, header = np.frombuffer(content, np.uint8), self._header(t, "camera_optical")
        self._send(topic, t, self._new("sensor_msgs/msg/CompressedImage", header=header, format=kind, data=data))

    def _camera_info(self, recording: Recording, t: float) -> Any:
        camera = recording.camera
        fx, fy, cx, cy = camera.intrinsics
        return self._new(
            "sensor_msgs/msg/CameraInfo",
            header=self._header(t, "camera_optical"),
            height=camera.height,
            width=camera.width,
            distortion_model="plumb_bob",
            d=np.zeros(5),
            k=np.array([fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
            r=np.eye(3).ravel(),
            p=np.array([fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]),
            binning_x=0,
            binning_y=0,
            roi=self._new(
                "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
            ),
        )

    def _maps(self, cells: OccupancyMap, t: float) -> None:
        classes = cells.cells()
        obstacles = np.full(classes.shape, -1, np.int8)
        obstacles[(classes == FREE) | (classes == TARGET)] = 0
        obstacles[classes == OBSTACLE] = 100
        oysters = np.where(classes == TARGET, 100, np.minimum(obstacles, 0)).astype(np.int8)
        for topic, grid in (("/map", obstacles), ("/oysters", oysters)):
            origin = self._new(
                "geometry_msgs/msg/Pose",
                position=self._bag.point((0.0, 0.0, 0.0)),
                orientation=self._bag.quaternion((0.0, 0.0, 0.0, 1.0)),
            )
            info = self._new(
                "nav_msgs/msg/MapMetaData",
                map_load_time=self._bag.time(t),
                resolution=cells.cfg.cell_m,
                width=grid.shape[1],
                height=grid.shape[0],
                origin=origin,
            )
            message = self._new(
                "nav_msgs/msg/OccupancyGrid", header=self._header(t, "map"), info=info, data=grid.ravel()
            )
            self._send(topic, t, message)

    def _transform(self, parent: str, child: str, transform: NDArray[np.float64], t: float) -> Any:
        return self._bag.transform(parent, child, transform[:3, 3], quaternion_of(transform[:3, :3]), t)
