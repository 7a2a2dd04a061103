"""Where a body was by a bag's satellite receiver alone: positions of NavSatFix, headings of Imu or of the course."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from coral.errors import InputError, first_line
from coral.limits import AUTOPILOT_SAMPLES
from coral.reef.recordings.autopilot_log import APART_S, GAP_S
from coral.reef.recordings.frame_tree import FrameTree, frame_name, points_down
from coral.reef.recordings.local_plane import MOST_DEGREES, LocalPlane
from coral.reef.recordings.picture_folder import FASTEST_M_S, FIX_M
from coral.reef.recordings.pose_track import ONE_CLOCK, ClockBackError, StampedTransforms, Transform
from coral.reef.recordings.transforms import body_transform, rotation_of
from coral.reef.world.geometry import Pose
from coral.ros.bag_reader import Bag, stamp_of
from coral.words import many

FIX, IMU = "sensor_msgs/msg/NavSatFix", "sensor_msgs/msg/Imu"
BASELINE_M, BASELINE_S = 3.0, 20.0
"""A course is that between fixes so far apart (m), and not longer after each other (s): over less, the error of a fix
against its neighbours, some decimetres, would turn it by more than ten degrees."""
BODY = "base_link"
"""Frame of the body (REP-105), if the bag has it."""


@dataclass
class GpsTrack:
    """A track by satellites; x east and y north of the first fix, z 0."""

    plane: LocalPlane
    child: str
    """Frame of the body."""
    remark: str
    """How it was made, for the user."""
    poses: StampedTransforms = field(default_factory=lambda: StampedTransforms(gap_s=GAP_S))
    """T_body^map."""


def topic_of(bag: Bag, kind: str, named: str) -> str | None:
    """Return the topic of a type that has a name, or the only one of that type; None without.

    Raises:
        InputError: There are several.
    """
    found = sorted(topic for topic, one in bag.message_types().items() if one == kind)
    if named in found or not found:
        return named if found else None
    if len(found) > 1:
        flag = "--topics.gps" if kind == FIX else "--topics.imu"
        raise InputError(bag.where, flag, f"{kind} on {', '.join(found[:5])}", "the name of one")
    return found[0]


def read_gps(bag: Bag, fix_topic: str, imu_topic: str | None, tree: FrameTree) -> GpsTrack:
    """Read positions, and headings of a compass if there are some, otherwise those of the way over ground.

    Raises:
        InputError: There are no positions, no headings, or a way that no vehicle drives.
    """
    fixes, turns = StampedTransforms(gap_s=GAP_S), StampedTransforms()
    frames = {"fix": "", "imu": ""}
    plane, without = None, 0
    for topic, message in bag.read_messages({fix_topic} | ({imu_topic} if imu_topic else set())):
        try:
            t = stamp_of(message)
            if topic == fix_topic:
                lat, lon = float(message.latitude), float(message.longitude)
                good = abs(lat) <= MOST_DEGREES and abs(lon) <= 180.0 and (lat or lon)
                if not good or int(message.status.status) < 0:
                    without += 1
                    continue
                plane = plane or LocalPlane(lat, lon)
                frames["fix"] = frames["fix"] or frame_name(message.header.frame_id)
                east, north = plane.from_degrees(lat, lon)
                _add(fixes, t, body_transform(Pose(east, north, 0.0), 0.0, 0.0, 0.0))
            elif (turned := _turn(message)) is not None:
                frames["imu"] = frames["imu"] or frame_name(message.header.frame_id)
                _add(turns, t, turned)
        except ClockBackError as error:
            raise InputError(bag.where, topic, error, ONE_CLOCK) from None
        except (AttributeError, ValueError) as error:
            raise InputError(bag.where, topic, first_line(error), "messages of its usual kind") from None
        if len(fixes.times) + len(turns.times) > AUTOPILOT_SAMPLES:
            raise InputError(bag.where, topic, f"more than {AUTOPILOT_SAMPLES} poses", "a bag of a dive; cut it")
    if plane is None:
        raise InputError(bag.where, fix_topic, f"{many(without, 'message')} without a fix", "positions of a receiver")
    if points_down(frames["imu"]):
        raise InputError(
            bag.where, str(imu_topic), f"turns of {frames['imu']}, whose z axis points down", "ENU (REP-103)"
        )
    _refuse_jumps(bag, fix_topic, fixes)
    child = BODY if BODY in tree.frames() else frames["imu"] or BODY
    by_compass = bool(turns.times)
    told = f"headings are those of {imu_topic}" if by_compass else (
        "headings are those of the way over ground: wrong where the vehicle drifts or drives sideways"
    )  # fmt: skip
    left_out = f"; {many(without, 'message')} without a fix left out" if without else ""
    track = GpsTrack(plane, child, f"positions are by GPS alone ({fix_topic}), {told}{left_out}")
    antenna = tree.first(child, frames["fix"])
    mount = tree.first(child, frames["imu"]) if by_compass else None
    lever = np.zeros(3) if antenna is None else antenna[:3, 3]
    back = np.eye(3) if mount is None else mount[:3, :3].T
    for t in turns.times if by_compass else fixes.times:
        at, turned = fixes.at(t), turns.at(t) if by_compass else _course(fixes, t)
        if at is None or turned is None:
            continue
        body = np.eye(4)
        body[:3, :3] = turned[:3, :3] @ back
        body[:2, 3] = at[:2, 3] - (body[:3, :3] @ lever)[:2]
        track.poses.add(t, body)
    if not track.poses.times:
        still = f"no Imu with an orientation, and no way of {BASELINE_M:g} m within {BASELINE_S:g} s for a course"
        expected = "sensor_msgs/Imu with an orientation (--topics.imu), or nav_msgs/Odometry"
        raise InputError(bag.where, "heading", "no Imu near the fixes in time" if by_compass else still, expected)
    return track


def _add(track: StampedTransforms, t: float, transform: Transform) -> None:
    if not track.times or not 0.0 <= t - track.times[-1] < APART_S:
        track.add(t, transform)


def _turn(message: Any) -> Transform | None:
    """Return the orientation of an Imu; None if it says that it has none (REP-145). Shape=(4, 4)."""
    q = message.orientation
    parts = (float(q.x), float(q.y), float(q.z), float(q.w))
    if float(message.orientation_covariance[0]) == -1.0 or not 0.5 < math.hypot(*parts) < 2.0:
        return None
    transform = np.eye(4)
    transform[:3, :3] = rotation_of(parts)
    return transform


def _course(fixes: StampedTransforms, t: float) -> Transform | None:
    """Return the turn of a body that looks where it drives; None where it hardly does. Shape=(4, 4)."""
    k = first = last = fixes.nearest(t)
    while True:
        way = fixes.transforms[last][:2, 3] - fixes.transforms[first][:2, 3]
        if float(np.hypot(*way)) >= BASELINE_M:
            return body_transform(Pose(0.0, 0.0, math.atan2(way[1], way[0])), 0.0, 0.0, 0.0)
        before, after = max(first - 1, 0), min(last + 1, len(fixes.times) - 1)
        if fixes.times[after] - fixes.times[before] > BASELINE_S or (before, after) == (first, last):
            return None
        # As far back as ahead, as long as there are fixes on both sides.
        first, last = before, after
        assert first <= k <= last


def _refuse_jumps(bag: Bag, topic: str, fixes: StampedTransforms) -> None:
    at = zip(fixes.times, fixes.transforms, strict=True)
    for (t, before), (later, after) in itertools.pairwise(at):
        away = float(np.hypot(*(after - before)[:2, 3]))
        if away > FIX_M + FASTEST_M_S * (later - t):
            found = f"{away:.0f} m from the fix before it, {later - t:.1f} s later, at {later:.1f} s"
            raise InputError(bag.where, topic, found, "a track that a vehicle can have driven; leave bad fixes out")
