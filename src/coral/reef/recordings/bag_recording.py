"""A ROS 2 bag or an MCAP file as a recording: camera, odometry, transforms."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path, PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, first_line
from coral.reef.eyes.backends import RGB
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.map.mapping import MapCfg
from coral.reef.recordings.frame_tree import BodyTrack, frame_name, points_down
from coral.reef.recordings.recorded_pictures import PicturePerception, recorded_frame
from coral.reef.recordings.recording import EXACT, RECORDED, PosedFrame, Recording
from coral.reef.recordings.transforms import NEAR_S, ONE_CLOCK, ClockBackError, camera_in_body, euler_of, transform_from
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose
from coral.ros.bag_reader import Bag, stamp_of
from coral.ros.camera_pictures import colours_in, lens_of, values_in

UPRIGHT = 0.5
"""Sine of the angle by which the picture's down axis or the line of sight may rise above the body's plane."""
SAME_CLOCK = "stamps of one clock; shift those of one, or make a folder of the pictures with poses.csv"


@dataclass(frozen=True, kw_only=True)
class BagTopics:
    """Topics of a recording; by default those that our own export writes."""

    image: str = "/camera/image/compressed"
    """Colour pictures, CompressedImage or Image."""
    depth: str = "/camera/depth/compressed"
    """Depth in millimetres of 16 bits or metres of 32 bits, CompressedImage (PNG) or Image."""
    classes: str = "/camera/classes/compressed"
    """Classes of pixels (0 water, 1 oyster, 2 obstacle, 3 seabed) in 8 bits, CompressedImage (PNG) or Image."""
    doubt: str = "/camera/doubt/compressed"
    """Probability that a pixel's class is wrong, in steps of 1/255, 8 bits; read if it is there."""
    seen_by: str = "/camera/seen_by"
    """String: who found classes and depth, exact, rgb or a file's name; read if it is there."""
    camera_info: str = "/camera/camera_info"
    odometry: str = "/odometry"
    map: str = "/map"
    """OccupancyGrid whose extent and cells the new map takes over, if it is there."""


@dataclass
class _Contents:
    """What a first pass over a bag collects: everything but pictures."""

    camera: RecordedCamera | None = None
    track: BodyTrack = field(default_factory=BodyTrack)
    camera_frame: str = ""
    area: tuple[float, float, float, float] | None = None
    cell_m: float | None = None
    counts: dict[str, int] = field(default_factory=dict)
    seen_by: str = RECORDED


def read_bag(
    path: Path,
    topics: BagTopics,
    camera: RecordedCamera | None = None,
    perception: PicturePerception | None = None,
    period_s: float = 0.0,
) -> Recording:
    """Read a ROS 2 bag's folder, or an MCAP file.

    The camera is by default that of camera_info and the transforms, the edge of a cell the bag's own where it has a
    map. With `perception`, what pictures show is what that sees in their colours, whatever else the bag has of them.
    `period_s` is the least time between two pictures that are used (s).

    Raises:
        InputError: It is no bag, or something in it is missing or wrong. Pictures are checked when they are read.
    """
    bag = Bag(path)
    where = bag.where
    contents = _collect(bag, topics)
    track = contents.track
    if not track.odometry.times:
        raise InputError(where, topics.odometry, "no messages", f"nav_msgs/Odometry; {_known(contents)}")
    kinds = {
        topics.doubt: "doubt", topics.classes: "labels", topics.depth: "depth", topics.image: "rgb",
    }  # fmt: skip
    wanted = (topics.image,) if perception else (topics.classes, topics.depth, topics.image)
    pictured = [name for name in wanted if contents.counts.get(name)]
    if topics.image not in pictured and len(pictured) < 2:
        raise InputError(where, topics.image, "no pictures", f"CompressedImage or Image; {_known(contents)}")
    if perception is None and contents.counts.get(topics.doubt):
        pictured.append(topics.doubt)
    found = camera or _with_mount(contents, where, topics)
    placed = track.tree.joins(track.child, contents.camera_frame)
    in_view = np.linalg.inv(camera_in_body(found.view))

    def mount_at(t: float) -> NDArray[np.float64] | None:
        return track.tree.at(track.child, contents.camera_frame, t) if placed else camera_in_body(found.view)

    remarks: tuple[str, ...] = ()
    usual_m = float(np.median([body[2, 3] for body in track.odometry.transforms]))
    if usual_m < 0.0:
        remarks = (_lift(track, usual_m, mount_at(track.odometry.times[0]), camera, where),)
    cfg = MapCfg() if contents.cell_m is None else MapCfg(cell_m=contents.cell_m)
    omitted: set[float] = set()

    def keyframes() -> Iterator[PosedFrame]:
        due, used = -math.inf, False
        for t, images in _moments(bag, set(pictured), track.odometry.span):
            if t < due - 1e-6:
                continue
            due = t + period_s
            at, mount = track.at(t), mount_at(t)
            if at is None or mount is None:
                omitted.add(t)
                continue
            # The pose is that of a body whose camera sits at its origin: what else the mount turns is roll and pitch.
            body = at[0] @ mount @ in_view
            roll, pitch, yaw = euler_of(body[:3, :3])
            pose = Pose(float(body[0, 3]), float(body[1, 3]), yaw)
            height_m = float(body[2, 3])
            place = f"{where} at {t:.3f} s"
            if not height_m > 0.0:
                raise InputError(place, "height", f"{height_m:g} m", "a height above the sea floor, where z is 0")
            attitude = CameraAttitude(height_m, roll, pitch)
            named = {kinds[topic]: partial(_image, message, place, kinds[topic]) for topic, message in images.items()}
            frame = recorded_frame(named, found, perception, attitude, place)
            yield PosedFrame(t=t, pose=pose, height_m=height_m, frame=frame, roll=roll, pitch=pitch, odometry=at[1])
            used = True
        if omitted and not used:
            raise InputError(
                where, "time", f"pictures from {min(omitted):.1f} to {max(omitted):.1f} s, poses from "
                f"{track.odometry.times[0]:.1f} to {track.odometry.times[-1]:.1f} s", SAME_CLOCK,
            )  # fmt: skip

    name = path.stem if path.suffix else path.name
    return Recording(
        name=name, source=where, camera=found.view, keyframes=keyframes, area=contents.area, map=cfg,
        seen_by=perception.name if perception else contents.seen_by, omitted=omitted, remarks=remarks,
    )  # fmt: skip


def _lift(
    track: BodyTrack, usual_m: float, mount: NDArray[np.float64] | None, camera: RecordedCamera | None, where: str
) -> str:
    """Count the heights of a track from the sea floor, not from the surface; return a remark on it.

    `usual_m` is the body's usual z, below the surface (m). Only the camera's file can tell the usual height.

    Raises:
        InputError: It does not.
    """
    if camera is None or not camera.altitude_given:
        raise InputError(
            where, "odometry", f"z of {usual_m:.2f} m, counted from the surface",
            "z from the sea floor, or altitude_m in --camera FILE.yaml: the camera's usual height above it",
        )  # fmt: skip
    offset_m = 0.0 if mount is None else float(mount[2, 3])
    track.lift[2, 3] = camera.view.altitude_m - usual_m - offset_m
    return f"heights: z is {usual_m:.2f} m, counted from the surface; {camera.view.altitude_m:g} m is the usual height"


def _image(message: Any, where: str, name: str) -> NDArray[Any]:
    return colours_in(message, where) if name == "rgb" else values_in(message, where, name)


def _moments(bag: Bag, pictures: set[str], poses: tuple[float, float]) -> Iterator[tuple[float, dict[str, Any]]]:
    """Return the pictures of each moment, those with one time stamp.

    `poses` are the times of the first and the last pose (s), for errors.
    """
    t_open, images = math.nan, dict[str, Any]()
    unstamped: set[str] = set()
    for topic, message in bag.read_messages(pictures):
        try:
            t = stamp_of(message)
        except AttributeError as error:
            raise InputError(bag.where, topic, first_line(error), "messages with a time stamp") from None
        if t == 0.0 and topic in unstamped:
            raise InputError(bag.where, topic, "messages without time stamps (all 0)", "stamps of when each was taken")
        if t == 0.0:  # once it may be the beginning of a simulation
            unstamped.add(topic)
        if images and t != t_open:
            if t < t_open - NEAR_S:
                _refuse_apart(bag, pictures, poses)
                raise InputError(bag.where, topic, f"{t:.3f} s after {t_open:.3f} s", ONE_CLOCK)
            yield t_open, images
            images = {}
        t_open, images[topic] = t, message
    if images:
        yield t_open, images


def _refuse_apart(bag: Bag, pictures: set[str], poses: tuple[float, float]) -> None:
    """Refuse topics of pictures whose times have nothing in common; `poses` are the first and the last pose's (s).

    Raises:
        InputError: There are some.
    """
    times: dict[str, list[float]] = {}
    for topic, message in bag.read_messages(pictures):
        times.setdefault(topic, []).append(stamp_of(message))
    spans = {topic: (min(found), max(found)) for topic, found in times.items()}
    if max(begin for begin, _ in spans.values()) > min(end for _, end in spans.values()) + NEAR_S:
        told = [f"{topic} from {begin:.1f} to {end:.1f} s" for topic, (begin, end) in sorted(spans.items())]
        found = ", ".join([*told, f"poses from {poses[0]:.1f} to {poses[1]:.1f} s"])
        raise InputError(bag.where, "time", found, SAME_CLOCK)


def _with_mount(contents: _Contents, where: str, topics: BagTopics) -> RecordedCamera:
    """Return the camera with the tilt of its mount."""
    camera = contents.camera
    if camera is None:
        raise InputError(where, topics.camera_info, "no messages", "sensor_msgs/CameraInfo, or --camera FILE.yaml")
    child, tree = contents.track.child, contents.track.tree
    mount = tree.first(child, contents.camera_frame)
    if mount is None:
        raise InputError(
            where, "/tf, /tf_static", f"no chain from {child} to {contents.camera_frame or 'the camera'} among "
            f"{', '.join(tree.frames()) or 'no frames'}", "one, or --camera FILE.yaml",
        )  # fmt: skip
    if max(float(mount[2, 1]), float(mount[2, 2])) > UPRIGHT:
        raise InputError(
            where, f"{child} to {contents.camera_frame}", "a camera that looks up or hangs upside down",
            "a body with z up (FLU, REP-103); convert one with z down (FRD), or give --camera FILE.yaml",
        )  # fmt: skip
    down = math.degrees(math.asin(max(-1.0, min(1.0, -float(mount[2, 2])))))
    return replace(camera, view=replace(camera.view, pitch_down_deg=round(down, 9)))


def _collect(bag: Bag, topics: BagTopics) -> _Contents:
    contents, where = _Contents(counts=bag.count_messages()), bag.where
    wanted = {topics.odometry, topics.camera_info, topics.map, topics.seen_by, "/tf", "/tf_static"}
    for topic, message in bag.read_messages(wanted):
        try:
            if topic == topics.odometry:
                _take_odometry(contents.track, message)
            elif topic == topics.camera_info:
                contents.camera_frame = frame_name(message.header.frame_id)
                contents.camera = contents.camera or RecordedCamera.of(
                    lens_of(message, topics.image), CameraCfg(), f"{where}: {topic}"
                )
            elif topic == topics.seen_by:
                said = str(message.data)  # a file of whoever wrote the bag is a name, not a path on this machine
                contents.seen_by = said if said in (EXACT, RGB) else f"{PurePath(said).name[:60]}, recorded"
            elif topic == topics.map:
                info = message.info
                cell_m = round(float(info.resolution), 6)
                x, y = info.origin.position.x, info.origin.position.y
                contents.area = (x, y, round(info.width * cell_m, 6), round(info.height * cell_m, 6))
                contents.cell_m = cell_m
            else:
                for one in message.transforms:
                    at = _transform(one.transform.translation, one.transform.rotation)
                    t = None if topic == "/tf_static" else stamp_of(one)
                    contents.track.tree.add(one.header.frame_id, one.child_frame_id, at, t)
        except InputError:
            raise
        except ClockBackError as error:
            raise InputError(where, topic, error, ONE_CLOCK) from None
        except (AttributeError, ValueError) as error:
            raise InputError(where, topic, first_line(error), "messages of its usual kind, in order of time") from None
    return contents


def _take_odometry(track: BodyTrack, message: Any) -> None:
    pose = message.pose.pose
    transform = _transform(pose.position, pose.orientation)
    parent, child = frame_name(message.header.frame_id), frame_name(message.child_frame_id)
    if not track.odometry.times:
        if points_down(parent) or points_down(child):
            raise ValueError(f"poses of {child} in {parent}, whose z axis points down: convert them to ENU (REP-103)")
        track.parent, track.child = parent, child
    elif (track.parent, track.child) != (parent, child):
        raise ValueError(f"poses of {child} in {parent} after others")
    track.odometry.add(stamp_of(message), transform)


def _transform(at: Any, turned: Any) -> NDArray[np.float64]:
    transform = transform_from(
        (float(at.x), float(at.y), float(at.z)), (float(turned.x), float(turned.y), float(turned.z), float(turned.w))
    )
    if not np.isfinite(transform).all():
        raise ValueError("a pose that is not finite")
    return transform


def _known(contents: _Contents) -> str:
    named = ", ".join(sorted(contents.counts)) or "none"
    return f"--topics.NAME names another topic; the bag has {named}"
