"""Frames: chains are composed, static ones hold at every time, and what is no tree is refused."""

import math

import numpy as np
import pytest

from coral.reef.recordings.frame_tree import BodyTrack, FrameTree, frame_name, points_down
from coral.reef.recordings.transforms import StampedTransforms, body_transform
from coral.reef.world.geometry import Pose


def moved(x, y=0.0, yaw=0.0):
    return body_transform(Pose(x, y, yaw), 0.0, 0.0, 0.0)


def test_static_and_moving_transforms_are_composed_along_the_chain():
    tree = FrameTree()
    tree.add("base_link", "camera_link", moved(1.0, yaw=math.pi / 2), None)
    for t, x in ((1.0, 0.0), (1.2, 1.0)):
        tree.add("camera_link", "camera_optical", moved(x), t)
    found = tree.at("base_link", "camera_optical", 1.1)
    assert found[:2, 3] == pytest.approx([1.0, 0.5])
    assert tree.at("base_link", "camera_optical", 9.0) is None
    assert tree.first("base_link", "camera_optical")[:2, 3] == pytest.approx([1.0, 0.0])
    assert tree.at("base_link", "base_link", 9.0) == pytest.approx(np.eye(4))


def test_names_are_the_same_with_and_without_the_slash_of_ros_1():
    tree = FrameTree()
    tree.add("/base_link", "/camera", np.eye(4), None)
    assert tree.joins("base_link", frame_name("/camera"))
    assert not tree.joins("camera", "base_link")
    assert list(tree.frames()) == ["base_link", "camera"]


def test_a_frame_with_two_parents_and_a_circle():
    tree = FrameTree()
    tree.add("a", "b", np.eye(4), None)
    with pytest.raises(ValueError, match="b below c and below a: a frame has one parent"):
        tree.add("c", "b", np.eye(4), None)
    tree.add("b", "a", np.eye(4), None)
    assert not tree.joins("map", "a")


@pytest.mark.parametrize(
    ("frame", "down"),
    [("world_ned", True), ("base_link_frd", True), ("NED", True), ("planned", False), ("odom", False)],
)
def test_a_name_tells_that_z_points_down(frame, down):
    assert points_down(frame) is down


def track(correction_t):
    found = BodyTrack(odometry=StampedTransforms(), parent="odom", child="base_link")
    found.odometry.add(1.0, moved(2.0))
    found.tree.add("map", "odom", moved(0.0, 0.5), correction_t)
    return found


@pytest.mark.parametrize("correction_t", [0.2, None])
def test_what_localization_corrects_comes_on_top_of_the_odometry_however_old_it_is(correction_t):
    body, odometry = track(correction_t).at(1.0)
    assert (body[0, 3], body[1, 3]) == (2.0, 0.5)
    assert odometry == Pose(2.0, 0.0, 0.0)
    assert track(correction_t).at(5.0) is None


def test_without_a_map_the_odometry_is_the_pose():
    found = track(None)
    found.tree = FrameTree()
    body, odometry = found.at(1.0)
    assert (body[0, 3], odometry) == (2.0, None)
