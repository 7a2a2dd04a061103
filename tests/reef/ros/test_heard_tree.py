import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.ros import heard_tree
from coral.reef.ros.heard_tree import HeardTree
from reef.ros.fake_ros import FakeNode, fake_type, mounted


@pytest.fixture
def heard(monkeypatch):
    monkeypatch.setattr(heard_tree, "ros_type", fake_type)
    node = FakeNode()
    return HeardTree(node, "--camera"), node.heard["/tf_static"]


def test_a_sensor_is_found_over_a_chain_of_frames(heard):
    tree, hear = heard
    assert tree.in_vehicle("lens") is None
    hear(mounted("/rov/base_link", "rov/arm", at=(1.0, 0.0, 0.0)))
    hear(mounted("rov/arm", "lens", at=(0.0, 0.5, 0.0)))
    assert tree.in_vehicle("/lens")[:3, 3].tolist() == [1.0, 0.5, 0.0]
    assert np.array_equal(tree.in_vehicle("rov/base_link"), np.eye(4))


def test_of_a_transform_that_comes_again_the_newest_holds(heard):
    tree, hear = heard
    for x in (1.0, 2.0):
        hear(mounted("base_link", "lens", at=(x, 0.0, 0.0)))
    assert tree.in_vehicle("lens")[0, 3] == 2.0


def test_without_the_messages_nothing_is_heard_and_it_says_why(monkeypatch):
    def missing(*words):
        raise InputError("--camera", "", "no tf2_msgs", "a ROS 2")

    monkeypatch.setattr(heard_tree, "ros_type", missing)
    tree = HeardTree(FakeNode(), "--camera")
    assert (tree.missing, tree.in_vehicle("lens")) == ("no tf2_msgs", None)
