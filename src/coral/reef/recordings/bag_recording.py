"""A ROS 2 bag or an MCAP file as a recording: camera, odometry, transforms."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, first_line
from coral.reef.camera import CameraCfg
from coral.reef.geometry import Frame, Pose
from coral.reef.mapping import MapCfg
from coral.reef.recordings.perception import Perceive, perceive_nothing
from coral.reef.recordings.picture_files import decode_depth, decode_labels, decode_rgb, frame_of
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.recordings.transforms import camera_in_body, euler_of, transform_from

NEAR_S = 0.1
"""Pictures, poses and transforms within this time of each other belong together (s)."""
DISTORTION = 1e-6


@dataclass(frozen=True, kw_only=True)
class BagTopics:
    """Topics of a recording; by default those that our own export writes."""

    image: str = "/camera/image/compressed"
    """Colour pictures, CompressedImage."""
    depth: str = "/camera/depth/compressed"
    """Depth in millimetres, CompressedImage with a PNG of 16 bits."""
    classes: str = "/camera/classes/compressed"
    """Classes of pixels (0 water, 1 oyster, 2 obstacle, 3 seabed), CompressedImage with a PNG of 8 bits."""
    camera_info: str = "/camera/camera_info"
    odometry: str = "/odometry"
    map: str = "/map"
    """OccupancyGrid whose extent and cells the new map takes over, if it is there."""


@dataclass
class _Contents:
    """What a first pass over a bag collects: everything but pictures."""

    camera: CameraCfg | None = None
    poses: list[tuple[float, NDArray[np.float64], str, str]] = field(default_factory=list)
    """Time (s), T_body^odom, frame of the odometry, frame of the body."""
    corrections: dict[str, list[tuple[float, NDArray[np.float64]]]] = field(default_factory=dict)
    """T_odom^map by child frame, in order of time."""
    static: dict[tuple[str, str], NDArray[np.float64]] = field(default_factory=dict)
    camera_frame: str = ""
    area: tuple[float, float, float, float] | None = None
    cell_m: float | None = None
    counts: dict[str, int] = field(default_factory=dict)


def is_bag(path: Path) -> bool:
    """Check whether a path is a ROS 2 bag or an MCAP file."""
    return path.suffix == ".mcap" or (path / "metadata.yaml").is_file()


def read_bag(
    path: Path,
    topics: BagTopics,
    camera: CameraCfg | None = None,
    cfg: MapCfg | None = None,
    perceive: Perceive = perceive_nothing,
) -> Recording:
    """Read a bag.

    Args:
        path: Folder of a ROS 2 bag, or an MCAP file.
        topics: Names of the topics.
        camera: The camera; None: from camera_info and the transforms.
        cfg: How pictures become a map; the edge of a cell is the bag's own where it has a map.
        perceive: Makes classes and depth of colour pictures where the bag has none.

    Raises:
        InputError: It is no bag, or something in it is missing or wrong. Pictures are checked when they are read.
    """
    where = str(path)
    contents = _collect(path, topics)
    if not contents.poses:
        raise InputError(where, topics.odometry, "no messages", f"nav_msgs/Odometry; {_known(contents)}")
    pictured = [name for name in (topics.classes, topics.depth, topics.image) if contents.counts.get(name)]
    if topics.image not in pictured and len(pictured) < 2:
        raise InputError(where, topics.image, "no pictures", f"CompressedImage; {_known(contents)}")
    found = camera or _with_mount(contents, where, topics)
    mount_inverse = _mount_inverse(contents, found)
    cfg = cfg or MapCfg()
    if contents.cell_m is not None:
        cfg = replace(cfg, cell_m=contents.cell_m)

    def keyframes() -> Iterator[PosedFrame]:
        for t, images in _moments(path, topics):
            at = _pose_at(contents, t, where)
            if at is None:
                continue
            camera_at, odometry = at
            body = camera_at @ mount_inverse
            roll, pitch, yaw = euler_of(body[:3, :3])
            pose = Pose(float(body[0, 3]), float(body[1, 3]), yaw)
            height_m = float(body[2, 3])
            place = f"{where} at {t:.3f} s"
            if not height_m > 0.0:
                raise InputError(place, "height", f"{height_m:g} m", "a height above the sea floor, z = 0 in the map")
            frame = _frame(images, topics, found, perceive, height_m, roll, pitch, place)
            yield PosedFrame(t=t, pose=pose, height_m=height_m, frame=frame, roll=roll, pitch=pitch, odometry=odometry)

    name = path.stem if path.suffix else path.name
    return Recording(name=name, source=where, camera=found, keyframes=keyframes, area=contents.area, map=cfg)


def _frame(
    images: dict[str, bytes], topics: BagTopics, camera: CameraCfg, perceive: Perceive, height_m: float, roll: float,
    pitch: float, where: str,
) -> Frame:  # fmt: skip
    rgb = decode_rgb(images[topics.image], camera, where) if topics.image in images else None
    if topics.classes in images and topics.depth in images:
        labels = decode_labels(images[topics.classes], camera, where)
        return frame_of(labels, decode_depth(images[topics.depth], camera, where), rgb)
    if rgb is None:
        raise InputError(where, "", "one picture without its fellow", "colour, or both classes and depth")
    return perceive(rgb, height_m=height_m, roll=roll, pitch=pitch, where=where)


def _moments(path: Path, topics: BagTopics) -> Iterator[tuple[float, dict[str, bytes]]]:
    """Return the pictures of each moment: those with one time stamp."""
    wanted = {topics.image, topics.depth, topics.classes}
    t_open, images = math.nan, dict[str, bytes]()
    for topic, message in _messages(path, wanted):
        t = _stamp(message)
        if images and t != t_open:
            yield t_open, images
            images = {}
        t_open, images[topic] = t, bytes(message.data)
    if images:
        yield t_open, images


def _pose_at(contents: _Contents, t: float, where: str) -> tuple[NDArray[np.float64], Pose | None] | None:
    """Return T_camera^map at a time, and the pose by odometry alone if it is corrected; None if nothing is near."""
    k = _nearest([pose[0] for pose in contents.poses], t)
    if abs(contents.poses[k][0] - t) > NEAR_S:
        return None
    _, body, parent, child = contents.poses[k]
    odometry: Pose | None = None
    corrections = contents.corrections.get(parent, [])
    corrected = body
    if corrections:
        corrected = corrections[_nearest([one[0] for one in corrections], t)][1] @ body
        odometry = Pose(float(body[0, 3]), float(body[1, 3]), euler_of(body[:3, :3])[2])
    mount = contents.static.get((child, contents.camera_frame))
    if mount is None:
        mount = contents.static.get(("", ""))
    assert mount is not None
    return corrected @ mount, odometry


def _nearest(times: list[float], t: float) -> int:
    k = bisect.bisect_left(times, t)
    if k == 0 or (k < len(times) and times[k] - t < t - times[k - 1]):
        return k
    return k - 1


def _with_mount(contents: _Contents, where: str, topics: BagTopics) -> CameraCfg:
    """Return the camera with the tilt of its mount."""
    camera = contents.camera
    if camera is None:
        raise InputError(where, topics.camera_info, "no messages", "sensor_msgs/CameraInfo, or --camera FILE.yaml")
    mount = contents.static.get((contents.poses[0][3], contents.camera_frame))
    if mount is None:
        raise InputError(
            where, "/tf_static", f"no transform from {contents.poses[0][3]} to {contents.camera_frame or 'the camera'}",
            "one, or --camera FILE.yaml",
        )  # fmt: skip
    down = math.degrees(math.asin(max(-1.0, min(1.0, -float(mount[2, 2])))))
    return replace(camera, pitch_down_deg=round(down, 9))


def _mount_inverse(contents: _Contents, camera: CameraCfg) -> NDArray[np.float64]:
    """Return the inverse of the mount that `camera` describes, and remember it where the bag has no transform.

    A body pose is that of a body whose camera sits at its origin: what else the mount turns goes into roll and pitch.
    """
    ours = camera_in_body(camera)
    contents.static.setdefault(("", ""), ours)
    return np.asarray(np.linalg.inv(ours), np.float64)


def _collect(path: Path, topics: BagTopics) -> _Contents:
    contents, where = _Contents(), str(path)
    with _opened(path) as reader:
        contents.counts = {one.topic: one.msgcount for one in reader.connections}
    wanted = {topics.odometry, topics.camera_info, topics.map, "/tf", "/tf_static"}
    for topic, message in _messages(path, wanted):
        try:
            if topic == topics.odometry:
                _take_odometry(contents, message)
            elif topic == topics.camera_info:
                contents.camera_frame = message.header.frame_id
                contents.camera = contents.camera or _camera(message, where, topic)
            elif topic == topics.map:
                info = message.info
                cell_m = round(float(info.resolution), 6)
                x, y = info.origin.position.x, info.origin.position.y
                contents.area = (x, y, round(info.width * cell_m, 6), round(info.height * cell_m, 6))
                contents.cell_m = cell_m
            else:
                _take_transforms(contents, message, static=topic == "/tf_static")
        except (AttributeError, ValueError) as error:
            raise InputError(where, topic, first_line(error), "a message of its usual kind") from None
    contents.poses.sort(key=lambda pose: pose[0])
    return contents


def _take_odometry(contents: _Contents, message: Any) -> None:
    pose = message.pose.pose
    transform = transform_from(_vector(pose.position), _quaternion(pose.orientation))
    if not np.isfinite(transform).all():
        raise ValueError("a pose that is not finite")
    contents.poses.append((_stamp(message), transform, message.header.frame_id, message.child_frame_id))


def _take_transforms(contents: _Contents, message: Any, *, static: bool) -> None:
    for one in message.transforms:
        parent, child = one.header.frame_id, one.child_frame_id
        if static:
            contents.static[parent, child] = _transform(one)
        elif parent == "map":
            contents.corrections.setdefault(child, []).append((_stamp(one), _transform(one)))


def _transform(stamped: Any) -> NDArray[np.float64]:
    return transform_from(_vector(stamped.transform.translation), _quaternion(stamped.transform.rotation))


def _camera(message: Any, where: str, topic: str) -> CameraCfg:
    fx, fy = float(message.k[0]), float(message.k[4])
    if len(message.d) and float(np.abs(message.d).max()) > DISTORTION:
        raise InputError(where, f"{topic}: d", "a distorted picture", "rectified pictures (image_proc, or --camera)")
    if not (fx > 0.0 and abs(fx - fy) <= 0.02 * fx):
        raise InputError(where, f"{topic}: k", f"focal lengths {fx:g} and {fy:g}", "square pixels (--camera overrides)")
    hfov = math.degrees(2.0 * math.atan(0.5 * message.width / fx))
    return CameraCfg(width=int(message.width), height=int(message.height), hfov_deg=round(hfov, 9))


def _messages(path: Path, wanted: set[str]) -> Iterator[tuple[str, Any]]:
    with _opened(path) as reader:
        connections = [one for one in reader.connections if one.topic in wanted]
        if not connections:
            return
        for connection, _, raw in reader.messages(connections=connections):
            try:
                message = reader.deserialize(raw, connection.msgtype)
            except Exception as error:  # a damaged message: the library has no common class for this
                raise InputError(str(path), connection.topic, first_line(error), "a whole message") from None
            yield connection.topic, message


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(str(path), "", "no package rosbags", "the extra bags: pip install 'coral[bags]'") from None
    try:
        reader = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
        reader.open()
    except (AnyReaderError, OSError, ValueError, AssertionError, AttributeError, KeyError, EOFError) as error:
        raise InputError(str(path), "", first_line(error), "a ROS 2 bag or an MCAP file") from None
    except Exception as error:
        if type(error).__module__.startswith("rosbags"):
            raise InputError(str(path), "", first_line(error), "a ROS 2 bag or an MCAP file") from None
        raise
    try:
        yield reader
    finally:
        reader.close()


def _known(contents: _Contents) -> str:
    named = ", ".join(sorted(contents.counts)) or "none"
    return f"--topics.NAME names another topic; the bag has {named}"


def _stamp(message: Any) -> float:
    stamp = message.header.stamp
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def _vector(v: Any) -> tuple[float, float, float]:
    return float(v.x), float(v.y), float(v.z)


def _quaternion(q: Any) -> tuple[float, float, float, float]:
    return float(q.x), float(q.y), float(q.z), float(q.w)
