"""Bags whose positions are those of a satellite receiver."""

import math
from copy import deepcopy

import numpy as np
import pytest

pytest.importorskip("rosbags")
pytest.importorskip("pyproj")

from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from coral.errors import InputError
from coral.reef.recordings.bag_export import write_bag
from coral.reef.recordings.bag_recording import BagTopics, read_bag
from coral.reef.recordings.local_plane import LocalPlane
from coral.reef.recordings.run_recording import read_run
from coral.reef.recordings.transforms import rotation_of
from coral.reef.sea.recorded_camera import RecordedCamera

PLANE = LocalPlane(36.95, -122.02)
FIX, IMU = "sensor_msgs/msg/NavSatFix", "sensor_msgs/msg/Imu"


@pytest.fixture(scope="module")
def bag(survey_run, tmp_path_factory):
    path = tmp_path_factory.mktemp("gps") / "patch_bag"
    write_bag(read_run(survey_run).located(), path, single_file=False)
    return path


def by_gps(source, path, *, compass=True, scale=1.0, shift=(0.0, 0.0, 0.0), change=lambda k, fix: fix, second=None):
    """Copy a bag with NavSatFix, and Imu, in place of its odometry; a way `scale` times as long."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types
    with (
        AnyReader([source], default_typestore=store) as reader,
        Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer,
    ):
        added = {
            one.topic: writer.add_connection(one.topic, one.msgtype, typestore=store)
            for one in reader.connections
            if one.topic not in ("/odometry", "/tf", "/map")
        }
        fixes = writer.add_connection("/ship/gps", FIX, typestore=store)
        if second:
            writer.add_connection(second, FIX, typestore=store)
        turns = writer.add_connection("/ship/imu", IMU, typestore=store)
        k = 0
        for connection, t, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            if connection.topic == "/tf_static" and any(shift):
                moved = message.transforms[0].transform.translation
                moved.x, moved.y, moved.z = shift
                writer.write(added[connection.topic], t, store.serialize_cdr(message, connection.msgtype))
            elif connection.topic in added:
                writer.write(added[connection.topic], t, raw)
            elif connection.topic == "/odometry":
                header, at = deepcopy(message.header), message.pose.pose
                header.frame_id = "camera_optical" if any(shift) else "base_link"
                q = at.orientation
                lever = rotation_of((q.x, q.y, q.z, q.w)) @ np.array(shift)
                lat, lon = np.ravel(
                    PLANE.to_degrees(
                        np.array([scale * at.position.x + lever[0]]), np.array([scale * at.position.y + lever[1]])
                    )
                )
                fix = kinds[FIX](
                    header=header, status=kinds["sensor_msgs/msg/NavSatStatus"](status=0, service=1), latitude=lat,
                    longitude=lon, altitude=12.0, position_covariance=np.zeros(9), position_covariance_type=0,
                )  # fmt: skip
                fix = change(k, fix)
                k += 1
                writer.write(fixes, t, store.serialize_cdr(fix, FIX))
                none = np.zeros(9)
                imu = kinds[IMU](
                    header=message.header, orientation=q, orientation_covariance=none if compass else np.full(9, -1.0),
                    angular_velocity=kinds["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0),
                    angular_velocity_covariance=none,
                    linear_acceleration=kinds["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0),
                    linear_acceleration_covariance=none,
                )  # fmt: skip
                writer.write(turns, t, store.serialize_cdr(imu, IMU))
    return path


def read(bag, path, **topics):
    camera = RecordedCamera.plain(read_bag(bag, BagTopics()).camera)
    return read_bag(path, BagTopics(**topics), camera)


def test_positions_by_gps_and_headings_of_a_compass(bag, tmp_path):
    there = list(read_bag(bag, BagTopics()).keyframes())
    found = read(bag, by_gps(bag, tmp_path / "gps"))
    back = list(found.keyframes())
    assert len(back) == len(there)
    first = there[0].odometry
    for ours, theirs in zip(there, back, strict=True):
        assert theirs.pose[:2] == pytest.approx((ours.odometry.x - first.x, ours.odometry.y - first.y), abs=0.01)
        assert math.remainder(theirs.pose.theta - ours.odometry.theta, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)
        assert theirs.height_m == pytest.approx(found.camera.altitude_m)
    assert found.remarks == ("positions are by GPS alone (/ship/gps), headings are those of /ship/imu",)
    lat, lon = np.ravel(PLANE.to_degrees(np.array([first.x]), np.array([first.y])))
    assert found.datum == pytest.approx((lat, lon), abs=1e-9)


def test_without_a_compass_the_course_is_the_heading(bag, tmp_path):
    found = read(bag, by_gps(bag, tmp_path / "course", compass=False, scale=4.0))
    assert "headings are those of the way over ground" in found.remarks[0]
    frames = list(found.keyframes())
    assert len(frames) > 30
    for before, at, after in zip(frames[5:], frames[6:], frames[7:], strict=False):
        way = math.atan2(after.pose.y - before.pose.y, after.pose.x - before.pose.x)
        assert abs(math.remainder(at.pose.theta - way, 2 * math.pi)) < math.radians(12.0)


def test_a_bag_without_any_heading_says_so(bag, tmp_path):
    path = by_gps(bag, tmp_path / "none", compass=False, scale=0.1)
    with pytest.raises(InputError, match="heading: found no Imu with an orientation, and no way of 3 m within 20 s"):
        read(bag, path)


def test_fixes_that_are_none_are_left_out_and_jumps_refused(bag, tmp_path):
    def lost(k, fix):
        if k in (3, 4):
            fix.status.status = -1
        if k == 5:
            fix.latitude = fix.longitude = 0.0
        return fix

    found = read(bag, by_gps(bag, tmp_path / "lost", change=lost))
    assert found.remarks[0].endswith("; 3 messages without a fix left out")

    def jump(k, fix):
        fix.latitude += 0.01 * (k == 7)
        return fix

    with pytest.raises(InputError, match=r"/ship/gps: found 11.. m from the fix before it, .* leave bad fixes out"):
        read(bag, by_gps(bag, tmp_path / "jump", change=jump))


def test_the_height_has_to_be_known(bag, tmp_path):
    path = by_gps(bag, tmp_path / "flat")
    with pytest.raises(InputError, match="height: found positions by GPS alone, which know none, expected altitude_m"):
        read_bag(path, BagTopics())


def test_one_of_several_receivers_has_to_be_named(bag, tmp_path):
    path = by_gps(bag, tmp_path / "two", second="/other/gps")
    with pytest.raises(InputError, match=r"--topics\.gps: found .* on /other/gps, /ship/gps, expected the name of one"):
        read(bag, path)
    assert len(list(read(bag, path, gps="/ship/gps").keyframes())) > 30


def test_the_receiver_may_sit_elsewhere_on_the_vehicle(bag, tmp_path):
    arm = (0.4, 0.2, 0.0)  # of the camera, too
    found = list(read(bag, by_gps(bag, tmp_path / "lever", shift=arm)).keyframes())
    there = [one.odometry for one in read_bag(bag, BagTopics()).keyframes()]
    at = [(p.x + c(p) * 0.4 - s(p) * 0.2, p.y + s(p) * 0.4 + c(p) * 0.2) for p in there]
    for one, (x, y) in zip(found, at, strict=True):
        assert one.pose[:2] == pytest.approx((x - at[0][0], y - at[0][1]), abs=0.01)


def c(pose):
    return math.cos(pose.theta)


def s(pose):
    return math.sin(pose.theta)
