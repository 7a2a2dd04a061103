import math

import pytest

from coral.errors import InputError
from coral.reef.ros import map_transform
from coral.reef.ros.map_transform import MapTransform, odometry_in_map
from coral.reef.world.geometry import Pose
from reef.ros.fake_ros import FakeNode, fake_type, message


def transform(parent="", child="", stamp=0.0):
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    placed = {"translation": zero, "rotation": {**zero, "w": 1.0}}
    return message(header={"frame_id": parent, "stamp": stamp}, child_frame_id=child, transform=placed)


@pytest.fixture(autouse=True)
def types(monkeypatch):
    monkeypatch.setattr(map_transform, "LISTEN_S", 0.0)
    stamped = "TransformStamped"
    monkeypatch.setattr(
        map_transform, "ros_type", lambda name: transform if name.endswith(stamped) else fake_type(name)
    )


def sent(node):
    return [each for topic, told in node.sent if topic == "/tf" for each in told.transforms]


def test_a_pose_in_both_frames_tells_where_one_is_in_the_other():
    at = odometry_in_map(Pose(1.0, 0.0, 0.0), Pose(4.0, 6.0, math.pi / 2))
    assert at == pytest.approx((4.0, 5.0, math.pi / 2))


def test_what_is_sent_says_where_the_odometry_is_in_the_map():
    node = FakeNode(stamp_s=7.0)
    made = MapTransform(node)
    made.publish("odom", Pose(1.0, 2.0, 0.0), Pose(4.0, 6.0, 0.0))
    (found,) = sent(node)
    assert (found.header.frame_id, found.child_frame_id, found.header.stamp) == ("map", "odom", 7.0)
    assert (found.transform.translation.x, found.transform.translation.y) == (3.0, 4.0)
    assert (found.transform.rotation.z, found.transform.rotation.w) == (0.0, 1.0)
    assert made.told == "map -> odom"


def test_our_own_transform_comes_back_and_is_nobody_elses():
    node = FakeNode(stamp_s=7.0)
    made = MapTransform(node)
    for _ in range(3):
        made.publish("odom", Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
        node.heard["/tf"](message(transforms=[]))
        node.heard["/tf"](node.sent[-1][1])
    assert len(sent(node)) == 3


@pytest.mark.parametrize("topic", ["/tf", "/tf_static"])
@pytest.mark.parametrize("parent", ["map", "/world"])
def test_who_tells_it_already_has_precedence(topic, parent):
    node = FakeNode(stamp_s=7.0)
    made = MapTransform(node)
    made.publish("odom", Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
    told = message(transforms=[])
    told.transforms = [transform("odom", "base_link", 3.0), transform(parent, "/odom", 3.0)]
    node.heard[topic](told)
    made.publish("odom", Pose(0.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0))
    assert len(sent(node)) == 1
    assert made.told == f"by another node: {parent.lstrip('/')} -> odom"


@pytest.mark.parametrize("frame", ["", "map"])
def test_odometry_in_the_map_needs_none(frame):
    node = FakeNode()
    MapTransform(node).publish(frame, Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0))
    assert sent(node) == []


def test_nothing_is_sent_where_it_is_switched_off():
    node = FakeNode()
    node.parameter = lambda name, default: {"publish_tf": "False"}.get(name, default)
    made = MapTransform(node)
    made.publish("odom", Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0))
    assert (sent(node), made.told) == ([], "off: publish_tf")


def test_nothing_is_sent_without_the_messages(monkeypatch):
    def missing(name):
        raise InputError("--vehicle", "", "no tf2_msgs", "ROS 2")

    monkeypatch.setattr(map_transform, "ros_type", missing)
    node = FakeNode()
    made = MapTransform(node)
    made.publish("odom", Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0))
    assert (sent(node), made.told) == ([], "off: no tf2_msgs")
