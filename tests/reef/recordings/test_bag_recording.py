"""Bags and MCAP files become maps."""

import math
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from bag_copies import copy_bag
from survey_runs import write_run

from coral.errors import InputError
from coral.reef.recordings.bag_export import write_bag
from coral.reef.recordings.bag_recording import BagTopics, read_bag
from coral.reef.recordings.recording import map_of
from coral.reef.recordings.run_recording import read_run
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg
from coral.ros.bag_reader import is_bag

pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def bags(survey_run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("bags")
    recording = read_run(survey_run).located()
    write_bag(recording, folder / "patch.mcap", single_file=True)
    write_bag(recording, folder / "patch_bag", single_file=False)
    return folder


@pytest.mark.parametrize("name", ["patch.mcap", "patch_bag"])
def test_a_round_trip_gives_the_same_map(bags, survey_run, name):
    there, back = read_run(survey_run).located(), read_bag(bags / name, BagTopics()).located()
    assert is_bag(bags / name)
    assert back.camera == there.camera
    assert back.size_m == there.size_m
    np.testing.assert_array_equal(map_of(back).cells(), map_of(there).cells())
    ours, theirs = list(there.keyframes()), list(back.keyframes())
    assert [one.t for one in ours] == pytest.approx([one.t for one in theirs])
    # Odometry drifts by 1 cm a picture; the transform map -> odom takes it back.
    np.testing.assert_allclose([one.pose for one in theirs], [one.pose for one in ours], atol=1e-9)
    np.testing.assert_allclose(theirs[-1].odometry, ours[-1].odometry, atol=1e-9)


def test_doubt_goes_through_a_bag(tmp_path):
    write_run(tmp_path / "doubtful", doubtful=True)
    there = replace(read_run(tmp_path / "doubtful").located(), seen_by="rgb")
    write_bag(there, tmp_path / "doubtful.mcap", single_file=True)
    back = read_bag(tmp_path / "doubtful.mcap", BagTopics()).located()
    assert back.seen_by == "rgb"
    ours, theirs = (next(iter(one.keyframes())).frame for one in (there, back))
    np.testing.assert_array_equal(theirs.doubt, ours.doubt)
    np.testing.assert_array_equal(map_of(back).cells(), map_of(there).cells())


def test_a_network_of_another_machine_is_a_name_and_no_path(survey_run, tmp_path):
    there = replace(read_run(survey_run).located(), seen_by="/theirs/net.onnx")
    write_bag(there, tmp_path / "x.mcap", single_file=True)
    assert read_bag(tmp_path / "x.mcap", BagTopics()).seen_by == "net.onnx, recorded"


def test_a_given_camera_wins(bags):
    camera = CameraCfg(width=80, height=60, hfov_deg=100.0)
    assert read_bag(bags / "patch.mcap", BagTopics(), RecordedCamera.plain(camera)).camera == camera


@pytest.mark.parametrize(
    ("topics", "said"),
    [
        (BagTopics(odometry="/odom"), "/odom: found no messages, expected nav_msgs/Odometry.*has /camera"),
        (BagTopics(classes="/none"), "found no pictures"),
        (BagTopics(camera_info="/none"), "--camera FILE.yaml"),
    ],
)
def test_what_is_missing_is_named_with_what_there_is(bags, topics, said):
    with pytest.raises(InputError, match=said):
        read_bag(bags / "patch.mcap", topics)


def test_a_damaged_file_is_told_in_one_line(bags, tmp_path):
    (tmp_path / "text.mcap").write_text("this is no recording\n")
    with pytest.raises(InputError, match=r"text\.mcap") as told:
        list(read_bag(tmp_path / "text.mcap", BagTopics()).keyframes())
    assert "\n" not in str(told.value)


def test_a_distorted_camera_is_rectified_unless_the_pictures_are(bags, tmp_path):
    def bent(topic, t, message):
        if topic == "/camera/camera_info":
            message.d = np.array([-0.2, 0.05, 0.0, 0.0, 0.0])
        return message

    path = copy_bag(bags / "patch_bag", tmp_path / "bent", bent)
    straight = read_bag(bags / "patch_bag", BagTopics())
    found = read_bag(path, BagTopics())
    assert found.camera.height > straight.camera.height  # the barrel shows more above and below
    assert found.camera.pitch_down_deg == straight.camera.pitch_down_deg
    one = next(iter(found.keyframes()))
    assert one.frame.labels.shape == (found.camera.height, found.camera.width)
    topics = BagTopics(image="/camera/image_rect/compressed")
    assert read_bag(path, topics).camera == straight.camera


def fisheye(name):
    def change(message):
        message.distortion_model, message.d = name, np.array([0.01, 0.0, 0.0, 0.0])

    return change


def binned(message):
    """Twice as many pixels on the sensor, and a border of 4 of them."""
    message.k = np.array(message.k)
    message.k[[0, 4]] *= 2.0
    message.k[[2, 5]] = 2.0 * (message.k[[2, 5]] + 0.5) - 0.5 + 4.0
    message.roi.x_offset, message.roi.y_offset = 4, 4
    message.roi.width, message.roi.height = 2 * message.width, 2 * message.height
    message.width, message.height = message.roi.width + 8, message.roi.height + 8
    message.binning_x = message.binning_y = 2


@pytest.mark.parametrize(("told", "same"), [(fisheye("fisheye"), fisheye("equidistant")), (binned, lambda _: None)])
def test_a_recorded_camera_is_that_of_a_live_one(bags, tmp_path, told, same):
    def stating(change):
        def changed(topic, t, message):
            if topic == "/camera/camera_info":
                change(message)
            return message

        return changed

    paths = [copy_bag(bags / "patch_bag", tmp_path / str(k), stating(one)) for k, one in enumerate((told, same))]
    found, expected = (read_bag(path, BagTopics()) for path in paths)
    assert found.camera == expected.camera
    assert next(iter(found.keyframes())).frame.labels.shape == (found.camera.height, found.camera.width)


def test_pictures_far_from_all_poses_are_left_out_and_counted(bags, tmp_path):
    def silent(topic, t, message):
        return None if topic == "/odometry" and 5.2 < t < 8.2 else message

    found = read_bag(copy_bag(bags / "patch_bag", tmp_path / "silent", silent), BagTopics())
    times = [one.t for one in found.keyframes()]
    assert len(times) == 41 - 6
    assert found.omitted == {5.5, 6.0, 6.5, 7.0, 7.5, 8.0}


def test_a_clock_that_goes_back_and_a_pose_that_is_none_are_one_line(bags, tmp_path):
    def back(topic, t, message):
        if topic == "/odometry" and t > 10.0:
            message.header.stamp.sec -= 5
        return message

    def nowhere(topic, t, message):
        if topic == "/odometry" and t > 10.0:
            message.pose.pose.position.x = float("nan")
        return message

    def late(topic, t, message):
        if topic.startswith("/camera") and topic.endswith("compressed") and t > 10.0:
            message.header.stamp.sec -= 5
        return message

    for name, change, said in (
        ("back", back, "/odometry: found a time stamp of 5.500 s after one of 10.000 s, expected one clock .* cut"),
        ("nowhere", nowhere, "/odometry: found a pose that is not finite"),
        ("late", late, r"found 5.500 s after 10.000 s, expected one clock that never goes back; cut the bag there"),
    ):
        path = copy_bag(bags / "patch_bag", tmp_path / name, change)
        with pytest.raises(InputError, match=said) as told:
            list(read_bag(path, BagTopics()).keyframes())
        assert "\n" not in str(told.value)


def test_pictures_between_two_poses_are_placed_between_them(bags, tmp_path):
    def shifted(topic, t, message):
        if topic in ("/camera/classes/compressed", "/camera/depth/compressed"):
            message.header.stamp.nanosec += 200_000_000
        return message

    path = copy_bag(bags / "patch_bag", tmp_path / "shifted", shifted)
    first, second = (next(iter(read_bag(p, BagTopics()).keyframes())) for p in (bags / "patch_bag", path))
    _, after = (one for one, _ in zip(read_bag(bags / "patch_bag", BagTopics()).keyframes(), range(2), strict=False))
    there = first.pose.x + 0.4 * (after.pose.x - first.pose.x)
    assert second.t == pytest.approx(0.2)
    # Localization's correction is that of the nearest stamp: it jumps by the drift of 1 cm a picture.
    assert second.pose.x == pytest.approx(there, abs=0.011)


def first_pose(path):
    return next(iter(read_bag(path, BagTopics()).keyframes())).pose


def named(**frames):
    """Return a change that renames frames, in every message that names one."""

    def change(topic, t, message):
        for one in (*getattr(message, "transforms", ()), *([message] if hasattr(message, "header") else ())):
            one.header.frame_id = frames.get(one.header.frame_id, one.header.frame_id)
            if hasattr(one, "child_frame_id"):
                one.child_frame_id = frames.get(one.child_frame_id, one.child_frame_id)
        return message

    return change


def test_frames_with_the_slash_of_ros_1_are_the_same_frames(bags, tmp_path):
    slashed = named(**{name: f"/{name}" for name in ("map", "odom", "base_link", "camera_optical")})
    path = copy_bag(bags / "patch_bag", tmp_path / "slashed", slashed)
    assert first_pose(path) == first_pose(bags / "patch_bag")


def test_a_correction_that_is_static_is_applied(bags, tmp_path):
    def only_static(topic, t, message):
        if topic == "/tf":
            return None
        if topic == "/tf_static":
            fixed = deepcopy(message.transforms[0])
            fixed.header.frame_id, fixed.child_frame_id = "map", "odom"
            fixed.transform.translation.x, fixed.transform.translation.y = 20.0, 3.0
            fixed.transform.rotation.x = fixed.transform.rotation.y = 0.0
            fixed.transform.rotation.z = fixed.transform.rotation.w = math.sqrt(0.5)
            message.transforms = [*message.transforms, fixed]
        return message

    found = next(
        iter(read_bag(copy_bag(bags / "patch_bag", tmp_path / "static", only_static), BagTopics()).keyframes())
    )
    assert found.pose[:2] == pytest.approx((20.0 - found.odometry.y, 3.0 + found.odometry.x))
    assert found.pose.theta == pytest.approx(found.odometry.theta + math.pi / 2)


def test_a_camera_at_the_end_of_a_chain_that_moves(bags, tmp_path):
    def chained(topic, t, message):
        if topic == "/tf_static":
            link = deepcopy(message.transforms[0])
            link.child_frame_id = "camera_link"
            link.transform.translation.x = 0.2
            link.transform.rotation.x = link.transform.rotation.y = link.transform.rotation.z = 0.0
            link.transform.rotation.w = 1.0
            mounts.extend(message.transforms)
            message.transforms = [link]
        elif topic == "/tf":
            optical = deepcopy(mounts[0])
            optical.header.stamp = message.transforms[0].header.stamp
            optical.header.frame_id = "camera_link"
            optical.transform.translation.x -= 0.2
            message.transforms = [*message.transforms, optical]
        return message

    mounts = []
    path = copy_bag(bags / "patch_bag", tmp_path / "chained", chained)
    assert first_pose(path) == pytest.approx(first_pose(bags / "patch_bag"))


def test_poses_whose_z_points_down_are_refused_by_the_frame_s_name(bags, tmp_path):
    path = copy_bag(bags / "patch_bag", tmp_path / "ned", named(odom="odom_ned"))
    with pytest.raises(InputError, match="base_link in odom_ned, whose z axis points down: convert them to ENU"):
        read_bag(path, BagTopics())


def test_a_camera_that_hangs_upside_down_is_refused(bags, tmp_path):
    def rolled(topic, t, message):
        if topic == "/tf_static":
            q = message.transforms[0].transform.rotation
            q.x, q.y, q.z, q.w = q.w, -q.z, q.y, -q.x  # turned by 180 degrees about the body's x axis
        return message

    path = copy_bag(bags / "patch_bag", tmp_path / "rolled", rolled)
    with pytest.raises(InputError, match="a camera that looks up or hangs upside down"):
        read_bag(path, BagTopics())


def test_heights_that_count_from_the_surface_need_the_camera_s_usual_height(bags, tmp_path):
    def deep(topic, t, message):
        if topic == "/odometry":
            message.pose.pose.position.z -= 12.0
        return message

    path = copy_bag(bags / "patch_bag", tmp_path / "deep", deep)
    there = read_bag(bags / "patch_bag", BagTopics())
    with pytest.raises(InputError, match=r"counted from the surface, expected .* altitude_m in --camera FILE\.yaml"):
        read_bag(path, BagTopics())
    back = read_bag(path, BagTopics(), RecordedCamera.plain(there.camera))
    assert "counted from the surface" in back.remarks[0]
    heights = [[one.height_m for one in which.keyframes()] for which in (there, back)]
    assert heights[1] == pytest.approx(heights[0])
    np.testing.assert_array_equal(map_of(back.located()).cells(), map_of(there.located()).cells())


def stamped_otherwise(stamp):
    def change(topic, t, message):
        if topic.startswith("/camera") and topic.endswith("compressed"):
            message.header.stamp.sec, message.header.stamp.nanosec = stamp(message.header.stamp)
        return message

    return change


def test_pictures_without_stamps_and_pictures_of_another_clock_are_named(bags, tmp_path):
    path = copy_bag(bags / "patch_bag", tmp_path / "none", stamped_otherwise(lambda stamp: (0, 0)))
    with pytest.raises(InputError, match="messages without time stamps"):
        list(read_bag(path, BagTopics()).keyframes())
    later = stamped_otherwise(lambda stamp: (stamp.sec + 1_700_000_000, stamp.nanosec))
    path = copy_bag(bags / "patch_bag", tmp_path / "other", later)
    with pytest.raises(InputError, match=r"pictures from 1700000000\.0 to 1700000020\.0 s, poses from 0\.0 to 20\.0 s"):
        list(read_bag(path, BagTopics()).keyframes())


def test_pictures_of_two_clocks_are_named_with_the_span_of_each(bags, tmp_path):
    def depth_only(topic, t, message):
        if topic == "/camera/depth/compressed":
            message.header.stamp.sec += 1_700_000_000
        return message

    path = copy_bag(bags / "patch_bag", tmp_path / "two", depth_only)
    with pytest.raises(InputError) as told:
        list(read_bag(path, BagTopics()).keyframes())
    assert "/camera/classes/compressed from 0.0 to 20.0 s, /camera/depth/compressed from 1700000000.0 to" in str(
        told.value
    )
    assert "poses from 0.0 to 20.0 s, expected stamps of one clock" in str(told.value)
